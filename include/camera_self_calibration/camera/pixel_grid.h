#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/image_field.h"
#include "camera_self_calibration/camera/image_weights.h"
#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {

struct PixelRay {
  Eigen::Vector2d pixel;
  Eigen::Vector3d ray;
  double weight = 1.0;
};

/// The points of the grid of ImageField that see, have a ray and lie at most `max_radius_px` from
/// the principal point.
std::vector<PixelRay> pixelGrid(const Camera& camera, const ImageField& field = {},
                                double max_radius_px = 1e9);

/// The points of that grid that count, and have a ray.
std::vector<PixelRay> pixelGrid(const Camera& camera, const ImageWeights& weights);

/// The points of that grid over an image of this size [px] that `unproject` gives a ray for.
std::vector<PixelRay> pixelGrid(
    int width, int height,
    const std::function<std::optional<Eigen::Vector3d>(const Eigen::Vector2d&)>& unproject,
    const ImageField& field = {});

/// The middles of 160 x 120 equal parts of the image that have a ray and lie at most
/// `max_radius_px` from the principal point: means over them are means over all pixels, while the
/// grid of ImageField gives its points on the image's border as much weight as all others.
std::vector<PixelRay> areaGrid(const Camera& camera, double max_radius_px);

/// Distance of a lens's projections from the pixels whose rays they are of, as they are: no
/// rotation is removed. Infinite where it cannot project one of them. `Lens` has `bool
/// project(const Eigen::Vector3d& ray, Eigen::Vector2d* pixel) const`.
template <typename Lens>
PixelError directDistance(const Lens& lens, const std::vector<PixelRay>& grid) {
  PixelError error;
  double sum = 0.0;
  for (const PixelRay& point : grid) {
    Eigen::Vector2d pixel;
    const double e = lens.project(point.ray, &pixel) ? (pixel - point.pixel).norm()
                                                     : std::numeric_limits<double>::infinity();
    sum += e * e;
    error.max = std::max(error.max, e);
  }
  error.rms = std::sqrt(sum / static_cast<double>(grid.size()));
  return error;
}

}  // namespace camera_self_calibration
