#pragma once

#include <Eigen/Core>
#include <vector>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

struct PixelRay {
  Eigen::Vector2d pixel;
  Eigen::Vector3d ray;
};

/// The points of a 40 x 30 grid over the image, its border included, that have a ray and lie at
/// most `max_radius_px` from the principal point.
std::vector<PixelRay> pixelGrid(const Camera& camera, double max_radius_px = 1e9);

}  // namespace camera_self_calibration
