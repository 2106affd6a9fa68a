// Writes the states of a made fleet, for the time and memory that merge_calibrations takes:
//   fleet_states --folder DIR [--cameras 100] [--bags 100] [--segments 10]
// Bags of a camera are a day apart. Every tenth camera is refocused half way. Few segments are
// simulated, and each bag takes its own from them, so that a state is made as fast as written.

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "benchmark/program_arguments.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/fleet/state_solution.h"
#include "camera_self_calibration/pipeline/state_file.h"
#include "camera_self_calibration/queue/candidate_window.h"
#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/segment_maker.h"

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kSecond = 1000000000;
constexpr std::int64_t kDay = 86400 * kSecond;
constexpr std::int64_t kBegin = 1700000000 * kSecond;
constexpr int kKinds = 20;  // of bags, of each of the two lenses
constexpr double kRefocus = 1.01;

Camera lensOf(bool refocused) {
  Intrinsics values(5);
  values << 300.0, 302.0, 318.0, 242.0, 0.95;
  if (refocused) values.head<2>() *= kRefocus;
  return Camera(CameraModel::kFov, 640, 480, values);
}

LearntState madeState(bool refocused, int kind, int segments) {
  LearntState state;
  state.camera = lensOf(refocused);
  state.state = CalibrationState::kConverged;
  for (int i = 0; i < segments; ++i) {
    SegmentOptions options;
    options.camera = state.camera;
    options.start_s = 1.0 + 5.0 * i;
    options.tracks.pixel_sigma = 0.2;
    const auto seed = static_cast<std::uint64_t>(1000 * kind + i + (refocused ? 500 : 0));
    Segment segment = makeSegment(options, seed).segment;
    segment.sequence = i + 1;
    state.segments.push_back(evaluateCandidate(CandidateOptions(), segment, state.camera));
  }
  state.bags = {recordOf(state).value()};
  return state;
}

// On the clock of its day.
void write(LearntState state, const std::filesystem::path& folder, int camera, int day) {
  const std::int64_t begin = kBegin + day * kDay;
  for (Candidate& candidate : state.segments) {
    for (Keyframe& keyframe : candidate.segment.keyframes) keyframe.stamp_ns += begin;
  }
  BagRecord& record = state.bags[0];
  record.camera = formatted("robot%d/front", camera);
  record.bag = formatted("robot%d/day%d.bag", camera, day);
  for (std::int64_t* stamp : {&record.begin_ns, &record.end_ns}) *stamp += begin;
  for (SegmentMark& mark : record.segments) {
    mark.begin_ns += begin;
    mark.end_ns += begin;
  }
  std::ofstream(folder / formatted("robot%d_day%d.state", camera, day), std::ios::binary)
      << encode(state);
}

int run(const ArgumentValues& values) {
  const int cameras = std::stoi(values.at("--cameras"));
  const int bags = std::stoi(values.at("--bags"));
  const int segments = std::stoi(values.at("--segments"));
  const std::filesystem::path folder = values.at("--folder");
  std::filesystem::create_directories(folder);
  std::vector<LearntState> made;
  for (int i = 0; i < 2 * kKinds; ++i) made.push_back(madeState(i % 2 == 1, i / 2, segments));
  Random random(1);
  for (int camera = 0; camera < cameras; ++camera) {
    for (int day = 0; day < bags; ++day) {
      const bool refocused = camera % 10 == 9 && 2 * day >= bags;
      const int kind = static_cast<int>(random.uniform(0.0, kKinds - 1e-9));
      write(made[static_cast<std::size_t>(2 * kind + (refocused ? 1 : 0))], folder, camera, day);
    }
  }
  return 0;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  const auto values = readArguments(
      argc, argv,
      {{"--folder", "made_states"}, {"--cameras", "100"}, {"--bags", "100"}, {"--segments", "10"}});
  return values ? run(*values) : 1;
}
