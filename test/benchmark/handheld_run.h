#pragma once

#include <cstdint>

#include "camera_self_calibration/simulation/random.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {

inline constexpr double kHandheldRateHz = 15.0;

/// Hand-held motion at that rate for `seconds` and one more, 100 features; its speed and the noise
/// of the tracks are the next two numbers of `random`.
TrackRunOptions handheldRun(std::uint64_t seed, double seconds, Random* random);

}  // namespace camera_self_calibration
