#pragma once

#include <cmath>

namespace camera_self_calibration {

constexpr double kDegree = M_PI / 180.0;  ///< [rad]

}  // namespace camera_self_calibration
