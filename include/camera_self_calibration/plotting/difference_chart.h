#pragma once

#include <opencv2/core/mat.hpp>

#include "camera_self_calibration/camera/pixel_difference.h"
#include "camera_self_calibration/plotting/palette.h"

namespace camera_self_calibration {

/// The differences between two calibrations over the image of `a`: colours tell how large they are,
/// arrows, magnified, where they point. BGR, 8 bits, 760 px wide.
cv::Mat drawDifference(const Camera& a, const PixelDifference& difference,
                       Theme theme = Theme::kLight);

}  // namespace camera_self_calibration
