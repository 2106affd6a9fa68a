#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace camera_self_calibration {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Rigid motion. Named `a_from_b`, so that products read off:
/// `d_from_a = d_from_c * c_from_b * b_from_a`.
struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< Unit quaternion.
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< Map units (monocular: scale unknown).

  Rigid3() = default;
  Rigid3(const Eigen::Quaterniond& q, const Eigen::Vector3d& t) : rotation(q), translation(t) {}

  Rigid3 inverse() const {
    const Eigen::Quaterniond inverse_rotation = rotation.conjugate();
    return {inverse_rotation, -(inverse_rotation * translation)};
  }
};

inline Eigen::Vector3d operator*(const Rigid3& a_from_b, const Eigen::Vector3d& point_in_b) {
  return a_from_b.rotation * point_in_b + a_from_b.translation;
}

/// The product's quaternion is normalised, so that long chains stay rotations.
inline Rigid3 operator*(const Rigid3& a_from_b, const Rigid3& b_from_c) {
  return {(a_from_b.rotation * b_from_c.rotation).normalized(), a_from_b * b_from_c.translation};
}

/// se(3) exponential and logarithm; the twist is (translation part, rotation part) [map unit, rad].
Rigid3 expSe3(const Vector6d& twist);
Vector6d logSe3(const Rigid3& motion);

}  // namespace camera_self_calibration
