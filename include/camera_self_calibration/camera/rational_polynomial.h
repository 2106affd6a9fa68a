#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace camera_self_calibration {

/// The eight coefficients that OpenCV and ROS call "rational_polynomial": a model to publish in,
/// not one to estimate. With x, y = point / z and q = x^2 + y^2 the distorted point is
/// `(x, y) (1 + k1 q + k2 q^2 + k3 q^3) / (1 + k4 q + k5 q^2 + k6 q^3)` plus radtan's tangential
/// terms.
struct RationalPolynomial {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< [px]
  std::array<double, 8> coefficients{};           ///< k1 k2 p1 p2 k3 k4 k5 k6.

  /// False, and `pixel` undefined, for a point not in front or at a pole of the fraction.
  bool project(const Eigen::Vector3d& point, Eigen::Vector2d* pixel) const;

  /// Unit ray through a pixel; nothing where the search for it does not end.
  std::optional<Eigen::Vector3d> unproject(const Eigen::Vector2d& pixel) const;
};

}  // namespace camera_self_calibration
