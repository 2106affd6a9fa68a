#pragma once

#include <cstdint>

namespace camera_self_calibration {

/// What lens changes without end cost, on simulated feature tracks of a fov lens: a focal length of
/// its own every `seconds`. Prints time per frame, memory held and what was noticed, by the number
/// of changes.
void printManyChanges(int changes, double seconds, std::uint64_t seed);

}  // namespace camera_self_calibration
