#include "benchmark/handheld_run.h"

namespace camera_self_calibration {

TrackRunOptions handheldRun(std::uint64_t seed, double seconds, Random* random) {
  TrackRunOptions run;
  run.seed = seed;
  run.rate_hz = kHandheldRateHz;
  run.max_features = 100;
  run.motion_speed = random->uniform(0.4, 1.0);
  run.pixel_sigma = random->uniform(0.1, 0.3);
  run.duration_s = seconds + 1.0;
  return run;
}

}  // namespace camera_self_calibration
