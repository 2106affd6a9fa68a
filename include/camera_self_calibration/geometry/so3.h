#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace camera_self_calibration {

/// Cross-product matrix: `skew(a) * b == a.cross(b)`.
Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/// Rotation by the angle |v| [rad] about the axis v/|v|; exact for any angle, smooth through zero.
Eigen::Quaterniond expSo3(const Eigen::Vector3d& v);

/// The rotation R that maximises trace(R^T C): for C = sum w a b^T it minimises sum w |a - R b|^2
/// over unit vectors (Kabsch).
Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& correlation);

/// Inverse of expSo3: the rotation vector [rad] of a unit quaternion, of length at most pi.
Eigen::Vector3d logSo3(const Eigen::Quaterniond& q);

}  // namespace camera_self_calibration
