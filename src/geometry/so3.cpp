#include "camera_self_calibration/geometry/so3.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace camera_self_calibration {

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Eigen::Quaterniond expSo3(const Eigen::Vector3d& v) {
  const double angle2 = v.squaredNorm();
  const double angle = std::sqrt(angle2);
  // sin(angle / 2) / angle; its series is exact to double precision below the branch.
  const double scale = angle < 1e-4 ? 0.5 - angle2 / 48.0 : std::sin(0.5 * angle) / angle;
  Eigen::Quaterniond q;
  q.w() = std::cos(0.5 * angle);
  q.vec() = scale * v;
  return q.normalized();
}

Eigen::Vector3d logSo3(const Eigen::Quaterniond& q) {
  const double sine = q.vec().norm();
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;  // q and -q are the same rotation
  const double half_angle = std::atan2(sine, sign * q.w());
  const double scale = sine < 1e-9 ? 2.0 : 2.0 * half_angle / sine;
  return sign * scale * q.vec();
}

Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& correlation) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1.0, 1.0, 1.0);
  signs.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace camera_self_calibration
