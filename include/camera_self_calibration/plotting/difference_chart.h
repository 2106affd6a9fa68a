#pragma once

#include "camera_self_calibration/camera/pixel_difference.h"
#include "camera_self_calibration/plotting/sheet.h"

namespace camera_self_calibration {

/// The differences between two calibrations over the image of `a`: colours show how large they are,
/// arrows, magnified, where they point. 500 px wide.
Sheet drawDifference(const Camera& a, const PixelDifference& difference);

}  // namespace camera_self_calibration
