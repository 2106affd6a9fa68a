#include "camera_self_calibration/geometry/rigid3.h"

#include <cmath>

#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

// Left Jacobian of SO(3): translation = V * (translation part of the twist).
Eigen::Matrix3d leftJacobian(const Eigen::Vector3d& rotation_vector) {
  const double angle2 = rotation_vector.squaredNorm();
  const double angle = std::sqrt(angle2);
  double a = 0.5 - angle2 / 24.0;
  double b = 1.0 / 6.0 - angle2 / 120.0;
  if (angle > 1e-3) {
    a = (1.0 - std::cos(angle)) / angle2;
    b = (angle - std::sin(angle)) / (angle2 * angle);
  }
  const Eigen::Matrix3d cross = skew(rotation_vector);
  return Eigen::Matrix3d::Identity() + a * cross + b * cross * cross;
}

}  // namespace

Rigid3 expSe3(const Vector6d& twist) {
  const Eigen::Vector3d rotation_vector = twist.tail<3>();
  return {expSo3(rotation_vector), leftJacobian(rotation_vector) * twist.head<3>()};
}

Vector6d logSe3(const Rigid3& motion) {
  const Eigen::Vector3d rotation_vector = logSo3(motion.rotation);
  Vector6d twist;
  twist << leftJacobian(rotation_vector).inverse() * motion.translation, rotation_vector;
  return twist;
}

}  // namespace camera_self_calibration
