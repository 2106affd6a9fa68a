#pragma once

#include <Eigen/Core>
#include <vector>

#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {

/// Where pixelDistance() comes from.
struct PixelDifference {
  struct Point {
    Eigen::Vector2d pixel;   ///< Of a's grid.
    Eigen::Vector2d offset;  ///< Where b sees the same ray, less `pixel` [px].
  };
  PixelError error;
  double rotation_deg = 0.0;  ///< Angle of the rotation that was removed.
  std::vector<Point> points;
  int refused = 0;  ///< Points of the grid whose ray `b` cannot project.
};

PixelDifference pixelDifference(const Camera& a, const Camera& b, double max_radius_px = 1e9);

}  // namespace camera_self_calibration
