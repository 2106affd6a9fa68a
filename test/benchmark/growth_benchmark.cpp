// What a frame and a keyframe cost as the trajectory grows, and the memory, on simulated feature
// tracks, in time of the processor, which other load disturbs least. Prints one JSON object.
// Arguments: keyframes (default 5000).

#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/simulation/feature_tracks.h"
#include "camera_self_calibration/simulation/room.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"

namespace camera_self_calibration {
namespace {

constexpr double kRateHz = 20.0;
constexpr double kLapSeconds = 600.0;  // the motion starts over, and the clock goes on

double residentMegabytes() {
  std::ifstream file("/proc/self/statm");
  long total = 0, resident = 0;
  file >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1048576.0;
}

FeatureTracks makeTracks() {
  const World room = makeRoom(RoomOptions());
  SyntheticMotionOptions motion;
  motion.box = room.free_space;
  motion.duration_s = kLapSeconds;
  motion.speed = 0.6;
  FeatureTracksOptions options;
  options.pixel_sigma = 0.1;
  const Camera camera = Camera::defaultGuess(CameraModel::kFov, 640, 480);
  return FeatureTracks(room, Lens{camera, std::nullopt, 1.0}, syntheticMotion(motion), options);
}

double cpuMilliseconds() {
  timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

// Times of the last stretch.
struct Stretch {
  std::vector<double> frame_ms;
  std::vector<double> keyframe_ms;
};

void print(long keyframes, const Stretch& stretch, bool* first) {
  std::printf(
      "%s\n  {\"keyframes\": %ld, \"frame_ms\": %.3f, \"keyframe_ms\": %.3f, "
      "\"resident_megabytes\": %.1f}",
      *first ? "" : ",", keyframes, median(stretch.frame_ms, 0.0), median(stretch.keyframe_ms, 0.0),
      residentMegabytes());
  std::fflush(stdout);
  *first = false;
}

void runUntil(long last) {
  FeatureTracks tracks = makeTracks();
  Stretch stretch;
  long keyframes = 0;
  Callbacks callbacks;
  bool at_keyframe = false;  // the back end was given one
  callbacks.calibration = [&](const CalibrationReport&) {
    at_keyframe = true;
    ++keyframes;
  };
  Options options;
  options.model = CameraModel::kFov;
  SelfCalibrator calibrator(options, SelfCalibrator::Mode::kInline, callbacks);
  bool first = true;
  long next = 100;
  std::printf("{\"growth\": [");
  const auto lap = static_cast<long>(kLapSeconds * kRateHz);
  for (long i = 0; keyframes < last; ++i) {
    const auto ns = [](long frame) { return static_cast<std::int64_t>(1e9 * frame / kRateHz); };
    // Back and forth along the motion, without a jump.
    const long phase = i % (2 * lap - 2);
    TrackedFrame frame = tracks.track(ns(phase < lap ? phase : 2 * lap - 2 - phase));
    frame.stamp_ns = ns(i);
    at_keyframe = false;
    const double before = cpuMilliseconds();
    calibrator.processTracks(frame, [&] { return tracks.detect(); });
    (at_keyframe ? stretch.keyframe_ms : stretch.frame_ms).push_back(cpuMilliseconds() - before);
    // Each row tells of the keyframes since two thirds of its count.
    if (keyframes < 2 * next / 3) stretch = Stretch();
    if (keyframes < next) continue;
    print(keyframes, stretch, &first);
    for (const long mark : {100L, 300L, 600L, 1200L, 2500L, last}) {
      if (mark > keyframes) {
        next = mark;
        break;
      }
    }
  }
  std::printf("\n]}\n");
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  camera_self_calibration::runUntil(argc > 1 ? std::atol(argv[1]) : 5000);
  return 0;
}
