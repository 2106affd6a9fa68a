#pragma once

#include <opencv2/core.hpp>

#include "camera_self_calibration/simulation/world.h"

namespace camera_self_calibration {

/// Paints a recipe for a surface of `width_m` x `height_m` [m]: CV_8UC1 with corners at many
/// scales, nothing repeated. Equal recipes give equal images. Detail is reduced where an image
/// would exceed 4096 texels a side.
cv::Mat paintTexture(const TextureRecipe& recipe, double width_m, double height_m);

}  // namespace camera_self_calibration
