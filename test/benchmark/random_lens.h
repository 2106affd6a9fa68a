#pragma once

#include <cstdint>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

/// A lens that a user may have, drawn for a series of trials.
struct RandomLens {
  Camera camera;
  double horizontal_fov_deg = 0.0;
};

/// Horizontal field of view: fov 60 to 140 degrees with w in [0.5, 1.1], pinhole 40 to 100, radtan
/// 50 to 110 (barrel distortion without k3), equidistant 80 to 170. The principal point is up to 3
/// % of the width from the centre, fy differs from fx by up to 2 %. The same seed gives the same
/// lens.
RandomLens randomLens(CameraModel model, int width, int height, std::uint64_t seed);

/// The models in turn: fov, radtan, equidistant, pinhole.
CameraModel modelOf(std::uint64_t seed);

}  // namespace camera_self_calibration
