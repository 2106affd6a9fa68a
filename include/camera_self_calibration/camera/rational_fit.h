#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/pixel_distance.h"

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
};

struct RationalFit {
  RationalPolynomial camera;
  PixelError error;  ///< Direct distance to the source over the image [px]; infinite where the fit
                     ///< cannot project a ray of the source.
};

/// The rational polynomial that projects most like `source` over its image: exact for pinhole and
/// radtan. Nothing where no fit is possible (too few pixels have rays in front of the camera).
std::optional<RationalFit> fitRationalPolynomial(const Camera& source);

}  // namespace camera_self_calibration
