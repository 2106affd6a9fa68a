#pragma once

#include "camera_self_calibration/geometry/rigid3.h"

namespace camera_self_calibration {

/// Rigid motion with a change of scale: from the frame of one monocular map to that of another.
/// Named `a_from_b`, as Rigid3.
struct Similarity3 {
  Rigid3 motion;
  double scale = 1.0;  ///< Lengths in a over lengths in b; positive.
};

inline Eigen::Vector3d operator*(const Similarity3& a_from_b, const Eigen::Vector3d& point_in_b) {
  return a_from_b.motion * Eigen::Vector3d(a_from_b.scale * point_in_b);
}

/// A camera's pose in another map: the camera itself has no scale.
inline Rigid3 operator*(const Similarity3& a_from_b, const Rigid3& b_from_camera) {
  return {(a_from_b.motion.rotation * b_from_camera.rotation).normalized(),
          a_from_b * b_from_camera.translation};
}

/// The similarity of a given scale that takes one pose to another.
inline Similarity3 similarityBetween(const Rigid3& a_from_camera, const Rigid3& b_from_camera,
                                     double scale) {
  const Eigen::Quaterniond rotation =
      (a_from_camera.rotation * b_from_camera.rotation.conjugate()).normalized();
  return {{rotation, a_from_camera.translation - rotation * (scale * b_from_camera.translation)},
          scale};
}

}  // namespace camera_self_calibration
