#include "camera_self_calibration/camera/rational_polynomial.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace camera_self_calibration {

bool RationalPolynomial::project(const Eigen::Vector3d& point, Eigen::Vector2d* pixel) const {
  const auto& k = coefficients;
  const double x = point.x() / point.z();
  const double y = point.y() / point.z();
  const double q = x * x + y * y;
  const double d = 1.0 + q * (k[5] + q * (k[6] + q * k[7]));
  if (!(point.z() > 0.0) || !(d > 0.0)) return false;
  const double scale = (1.0 + q * (k[0] + q * (k[1] + q * k[4]))) / d;
  const double u = x * scale + 2.0 * k[2] * x * y + k[3] * (q + 2.0 * x * x);
  const double v = y * scale + k[2] * (q + 2.0 * y * y) + 2.0 * k[3] * x * y;
  *pixel = Eigen::Vector2d(fx * u + cx, fy * v + cy);
  return pixel->allFinite();
}

// Newton's method in the plane z = 1; the Jacobian numerically, since nothing here is in a hurry. A
// step that leads further away is halved.
std::optional<Eigen::Vector3d> RationalPolynomial::unproject(const Eigen::Vector2d& pixel) const {
  constexpr int kRounds = 50;
  constexpr double kStep = 1e-6;
  constexpr double kClose = 1e-9;  // [px]
  Eigen::Vector2d at((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  Eigen::Vector2d seen;
  Eigen::Vector2d step = Eigen::Vector2d::Zero();
  double error = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kRounds; ++i) {
    const Eigen::Vector2d next = at - step;
    if (!project(next.homogeneous(), &seen) || !((seen - pixel).norm() < error)) {
      if (!std::isfinite(error)) return std::nullopt;
      step *= 0.5;
      continue;
    }
    at = next;
    error = (seen - pixel).norm();
    if (error < kClose) return at.homogeneous().normalized();
    Eigen::Matrix2d j;
    for (int k = 0; k < 2; ++k) {
      Eigen::Vector2d shifted;
      if (!project((at + kStep * Eigen::Vector2d::Unit(k)).homogeneous(), &shifted)) {
        return std::nullopt;
      }
      j.col(k) = (shifted - seen) / kStep;
    }
    step = j.inverse() * (seen - pixel);
    if (!step.allFinite()) return std::nullopt;
  }
  constexpr double kCloseEnough = 1e-4;  // [px]
  if (error > kCloseEnough) return std::nullopt;
  return at.homogeneous().normalized();
}

}  // namespace camera_self_calibration
