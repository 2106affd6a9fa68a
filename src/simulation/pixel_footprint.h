#pragma once

#include <Eigen/Core>

#include "camera_self_calibration/simulation/ray_tiles.h"
#include "camera_self_calibration/simulation/surface_view.h"

namespace camera_self_calibration {

/// Shades a surface at the rays of a tile. The change of the texture position over one pixel
/// follows from the quotient rule: d(x/q) = (dx - (x/q) dq) / q, with x, y, q linear in the ray.
class PixelFootprint {
 public:
  PixelFootprint(const RayTile& tile, const SurfaceView& view)
      : view_(view), column_(along(tile.d_column)), row_(along(tile.d_row)) {}

  /// Gray value of the texture, averaged over the pixel whose centre is `ray`.
  float shade(const Eigen::Vector3f& ray) const {
    const float distance = 1.0f / view_.inverse_distance.dot(ray);
    const float x = view_.x.dot(ray) * distance;
    const float y = view_.y.dot(ray) * distance;
    return view_.texture->sampleFootprint(x, y, (column_.x() - x * column_.z()) * distance,
                                          (column_.y() - y * column_.z()) * distance,
                                          (row_.x() - x * row_.z()) * distance,
                                          (row_.y() - y * row_.z()) * distance);
  }

 private:
  Eigen::Vector3f along(const Eigen::Vector3f& d) const {
    return {view_.x.dot(d), view_.y.dot(d), view_.inverse_distance.dot(d)};
  }

  const SurfaceView& view_;
  Eigen::Vector3f column_;  // change of (x, y, q) per column
  Eigen::Vector3f row_;     // change of (x, y, q) per row
};

}  // namespace camera_self_calibration
