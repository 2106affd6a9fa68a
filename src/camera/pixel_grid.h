#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/image_field.h"

namespace camera_self_calibration {

struct PixelRay {
  Eigen::Vector2d pixel;
  Eigen::Vector3d ray;
};

/// The points of the grid of ImageField that see, have a ray and lie at most `max_radius_px` from
/// the principal point.
std::vector<PixelRay> pixelGrid(const Camera& camera, const ImageField& field = {},
                                double max_radius_px = 1e9);

/// The points of that grid over an image of this size [px] that `unproject` gives a ray for.
std::vector<PixelRay> pixelGrid(
    int width, int height,
    const std::function<std::optional<Eigen::Vector3d>(const Eigen::Vector2d&)>& unproject,
    const ImageField& field = {});

}  // namespace camera_self_calibration
