#pragma once

#include <string>

#include "camera_self_calibration/pipeline/results.h"

namespace camera_self_calibration {

/// "fov, 640 x 480".
std::string modelText(const Camera& camera);

/// "expected error 0.12 px rms, 0.40 px at most"; empty without an estimate.
std::string errorText(const CalibrationReport& report);

/// "fx [px]", "w [rad]", "k1".
std::string parameterTitle(const Camera& camera, int index);

/// "311.20 ± 0.06 (3 sigma)", with the decimals that the sigma deserves; "held at 0.1" for sigma 0;
/// the value alone if sigma is not a number.
std::string valueText(double value, double sigma);

/// The text, or its beginning and "..." if it is wider than `width` in letters of `size` [px].
std::string fitted(const std::string& text, double width, double size);

}  // namespace camera_self_calibration
