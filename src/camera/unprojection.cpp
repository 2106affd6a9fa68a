// Camera::unproject: pixels to unit rays.

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "camera_self_calibration/camera/camera.h"
#include "odd_polynomial.h"

namespace camera_self_calibration {
namespace {

constexpr double kHalfPi = 1.57079632679489661923;

double sinc(double x) { return std::abs(x) < 1e-4 ? 1.0 - x * x / 6.0 : std::sin(x) / x; }

}  // namespace

std::optional<Eigen::Vector3d> Camera::unproject(const Eigen::Vector2d& pixel) const {
  if (!valid_ || !pixel.allFinite()) return std::nullopt;
  const Eigen::Vector2d distorted((pixel.x() - parameters_[2]) / parameters_[0],
                                  (pixel.y() - parameters_[3]) / parameters_[1]);
  switch (model_) {
    case CameraModel::kPinhole:
      return Eigen::Vector3d(distorted.x(), distorted.y(), 1.0).normalized();
    case CameraModel::kFov:
      return unprojectFov(distorted);
    case CameraModel::kRadtan:
      return unprojectRadtan(distorted);
    case CameraModel::kEquidistant:
      return unprojectEquidistant(distorted);
  }
  return std::nullopt;
}

bool Camera::unproject(const Eigen::Vector2d& pixel, Eigen::Vector3d* ray,
                       RayIntrinsicsJacobian* d_parameters) const {
  const std::optional<Eigen::Vector3d> found = unproject(pixel);
  if (!found) return false;
  *ray = *found;
  if (!d_parameters) return true;
  Eigen::Vector2d back;
  Matrix23d j;
  PixelIntrinsicsJacobian d_pixel;
  if (!project(*ray, &back, &j, &d_pixel)) return false;
  const Eigen::Matrix2d jjt = j * j.transpose();
  const Eigen::Matrix<double, 3, 2> pseudo_inverse = j.transpose() * jjt.inverse();
  d_parameters->noalias() = -pseudo_inverse * d_pixel;
  return d_parameters->allFinite();
}

std::optional<Eigen::Vector3d> Camera::unprojectFov(const Eigen::Vector2d& distorted) const {
  // r_d w = atan(k r / z), hence r : z = sin(r_d w) / k : cos(r_d w).
  const double angle = distorted.norm() * parameters_[4];
  if (!(angle < kHalfPi)) return std::nullopt;
  const Eigen::Vector2d xy = sinc(angle) * distorted;
  return Eigen::Vector3d(xy.x(), xy.y(), fov_k_by_w_ * std::cos(angle)).normalized();
}

std::optional<Eigen::Vector3d> Camera::unprojectEquidistant(
    const Eigen::Vector2d& distorted) const {
  const double* k = parameters_.data() + 4;
  const OddPolynomial radial{{k[0], k[1], k[2], k[3]}};
  const double radius = distorted.norm();
  const std::optional<double> theta = radial.inverse(radius, max_radius_);
  if (!theta || *theta >= max_radius_) return std::nullopt;
  const double scale = radius > 0.0 ? std::sin(*theta) / radius : 1.0;
  return Eigen::Vector3d(scale * distorted.x(), scale * distorted.y(), std::cos(*theta));
}

std::optional<Eigen::Vector3d> Camera::unprojectRadtan(const Eigen::Vector2d& distorted) const {
  const double k3 = parameterCount() == kMaxIntrinsics ? parameters_[8] : 0.0;
  const OddPolynomial radial{{parameters_[4], parameters_[5], k3, 0.0}};
  const double radius = distorted.norm();
  if (radius == 0.0 && parameters_.segment<2>(6).isZero(0.0)) return Eigen::Vector3d::UnitZ();
  // Start without the tangential terms, just inside the fold where the pixel lies beyond it.
  const double inner = std::min(radial.inverse(radius, max_radius_).value_or(max_radius_),
                                (1.0 - 1e-6) * max_radius_);
  Eigen::Vector3d point(0.0, 0.0, 1.0);
  if (radius > 0.0) point.head<2>() = distorted * (inner / radius);

  // Newton in the plane z = 1, with steps halved until the residual falls.
  const Eigen::Vector2d scale = parameters_.head<2>();
  const Eigen::Vector2d target = distorted.cwiseProduct(scale) + parameters_.segment<2>(2);
  Eigen::Vector2d pixel;
  Matrix23d j;
  if (!project(point, &pixel, &j)) return std::nullopt;
  Eigen::Vector2d error = (pixel - target).cwiseQuotient(scale);
  for (int i = 0; i < 50 && error.norm() > 5e-16; ++i) {
    const Eigen::Matrix2d slope = scale.cwiseInverse().asDiagonal() * j.leftCols<2>();
    Eigen::Vector2d step = -slope.inverse() * error;
    Eigen::Vector3d next = point;
    Eigen::Vector2d next_error;
    int halvings = 0;
    for (; halvings < 40; ++halvings, step *= 0.5) {
      next.head<2>() = point.head<2>() + step;
      if (!project(next, &pixel, &j)) continue;
      next_error = (pixel - target).cwiseQuotient(scale);
      if (next_error.squaredNorm() < error.squaredNorm()) break;
    }
    if (halvings == 40) break;  // The residual is at the level of rounding, or of a fold.
    point = next;
    error = next_error;
  }
  if (!(error.norm() <= 1e-12 * (1.0 + radius))) return std::nullopt;
  return point.normalized();
}

}  // namespace camera_self_calibration
