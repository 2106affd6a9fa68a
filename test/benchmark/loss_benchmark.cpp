// What repeated loss costs: simulated feature tracks, the lens covered again and again. Time of the
// processor per image and memory, by the number of losses.
//
//   loss_benchmark [LOSSES]

#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/simulation/random.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {
namespace {

constexpr double kRate = 15.0;
constexpr int kSeen = 30;   // images between two losses
constexpr int kBlind = 10;  // images of a loss

double cpuSeconds() {
  timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double residentMegabytes() {
  std::ifstream file("/proc/self/statm");
  long total = 0, resident = 0;
  file >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1048576.0;
}

// No two features look alike, so that every map stays one of its own: the memory of places fills.
std::vector<Appearance> looks(const std::vector<Track>& tracks, int) {
  std::vector<Appearance> result;
  for (const Track& track : tracks) {
    Random random(static_cast<std::uint64_t>(track.id));
    Appearance appearance{track.id, track.pixel, {}};
    for (std::uint8_t& byte : appearance.descriptor) {
      byte = static_cast<std::uint8_t>(random.integer(0, 255));
    }
    result.push_back(appearance);
  }
  return result;
}

FeatureTracks makeTracks(const Camera& camera, double duration_s) {
  const World room = makeRoom(RoomOptions());
  SyntheticMotionOptions motion;
  motion.box = room.free_space;
  motion.duration_s = duration_s;
  motion.speed = 0.6;
  return FeatureTracks(room, Lens{camera, std::nullopt, 1.0}, syntheticMotion(motion),
                       FeatureTracksOptions());
}

struct Counts {
  int lost = 0;
  int relocalized = 0;
  int changes = 0;
  std::uint64_t map_id = 0;
};

Callbacks counting(Counts* counts) {
  Callbacks callbacks;
  callbacks.event = [counts](const Event& event) {
    counts->lost += event.type == EventType::kLost;
    counts->relocalized += event.type == EventType::kRelocalized;
    counts->changes += event.type == EventType::kCalibrationChange;
  };
  callbacks.frame = [counts](const FrameResult& frame) { counts->map_id = frame.map_id; };
  return callbacks;
}

void run(int losses) {
  const Camera camera = camera640(CameraModel::kFov, {320, 322, 316, 243, 0.95});
  const int learning = 150;
  FeatureTracks tracks = makeTracks(camera, (learning + losses * (kSeen + kBlind)) / kRate);
  Counts counts;
  SelfCalibrator calibrator(optionsFor(CameraModel::kFov), SelfCalibrator::Mode::kInline,
                            counting(&counts));
  std::printf(
      "| losses | ms a frame | resident [MB] | LOST | RELOCALIZED | changes | error of the "
      "calibration [px rms] |\n|---|---|---|---|---|---|---|\n");
  const int stretch = losses / 5;
  double begin = cpuSeconds();
  for (int i = 0; i < learning + losses * (kSeen + kBlind); ++i) {
    const int since = i - learning;
    const bool blind = since >= 0 && since % (kSeen + kBlind) < kBlind;
    if (blind) tracks.reset();
    TrackedFrame frame = tracks.track(static_cast<std::int64_t>(1e9 * (1.0 + i / kRate)));
    calibrator.processTracks(
        frame, [&] { return blind ? std::vector<Track>() : tracks.detect(); }, looks);
    const int done = (since + 1) / (kSeen + kBlind);
    if (since < 0) begin = cpuSeconds();
    if (since <= 0 || (since + 1) % (stretch * (kSeen + kBlind)) != 0) continue;
    const CalibrationReport report = calibrator.calibration();
    std::printf("| %d | %.2f | %.0f | %d | %d | %d | %.3f |\n", done,
                1e3 * (cpuSeconds() - begin) / (stretch * (kSeen + kBlind)), residentMegabytes(),
                counts.lost, counts.relocalized, counts.changes,
                pixelDistance(camera, report.camera).rms);
    std::fflush(stdout);
    begin = cpuSeconds();
  }
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  camera_self_calibration::run(argc > 1 ? std::max(5, std::atoi(argv[1])) : 1000);
}
