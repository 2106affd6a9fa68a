#pragma once

#include <Eigen/Core>
#include <vector>

#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {

/// How far two cameras are apart, and where. Unlike in pixelDistance(), whose few points reach the
/// border of the image, the rms is that over all pixels.
struct PixelDifference {
  struct Point {
    Eigen::Vector2d pixel;   ///< Of a.
    Eigen::Vector2d offset;  ///< Where b sees the same ray, less `pixel` [px].
  };
  PixelError error;
  double rotation_deg = 0.0;   ///< Angle of the rotation that was removed.
  std::vector<Point> samples;  ///< Evenly over the image's area.
  std::vector<Point> points;   ///< On the grid of ImageField, from border to border.
  int refused = 0;             ///< Points of that grid whose ray `b` cannot project.
};

PixelDifference pixelDifference(const Camera& a, const Camera& b, double max_radius_px = 1e9);

}  // namespace camera_self_calibration
