#pragma once

#include <string>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

/// Why intrinsics cannot be those of any camera with images of this size, as a part of a sentence;
/// empty if they can. Bounds that no lens comes near: focal lengths of a tenth to fifty times the
/// image's longer side (a lens of 180 degrees has a third, a telescope of two degrees thirty
/// times), a ratio of the two of at most four (half the lines of interlaced video make two), a
/// principal point at most twenty image sizes outside, as in a small image cut out of a large one,
/// and no coefficient that moves a corner by more than a thousand times its distance from there.
std::string implausibility(const Camera& camera);

}  // namespace camera_self_calibration
