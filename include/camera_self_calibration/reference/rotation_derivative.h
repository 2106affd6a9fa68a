#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {

using Matrix34d = Eigen::Matrix<double, 3, 4>;

/// `d (R(q) v) / d q` for q = (u, w), in the order x y z w: R(q) v = v + 2 w u x v + 2 u x (u x v),
/// whose last term is 2 (u (u.v) - v (u.u)).
inline Matrix34d rotationDerivative(const Eigen::Quaterniond& q, const Eigen::Vector3d& v) {
  const Eigen::Vector3d u = q.vec();
  Matrix34d d;
  d.leftCols<3>() = -2.0 * q.w() * skew(v) + 2.0 * (u.dot(v) * Eigen::Matrix3d::Identity() +
                                                    u * v.transpose() - 2.0 * v * u.transpose());
  d.col(3) = 2.0 * u.cross(v);
  return d;
}

}  // namespace camera_self_calibration
