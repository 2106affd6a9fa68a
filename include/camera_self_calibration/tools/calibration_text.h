#pragma once

#include <string>

#include "camera_self_calibration/camera/pixel_difference.h"
#include "camera_self_calibration/tools/calibration_file.h"

namespace camera_self_calibration {

/// "cam.yaml (ros): radtan, 640 x 480" and a line of its parameters.
std::string describe(const std::string& path, const CalibrationInFile& file);

/// The comparison of two calibrations in words: distance in pixels, in all and by distance from
/// the principal point, and the parameters beside each other if they have the same model.
std::string comparisonText(const Camera& a, const Camera& b, const PixelDifference& difference);

}  // namespace camera_self_calibration
