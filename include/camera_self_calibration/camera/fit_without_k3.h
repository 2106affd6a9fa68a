#pragma once

#include <optional>

#include "camera_self_calibration/camera/fit.h"

namespace camera_self_calibration {

/// The radtan camera with four coefficients that projects most like one with five; for programs
/// that know no k3.
std::optional<CameraFit> fitWithoutK3(const Camera& radtan);

}  // namespace camera_self_calibration
