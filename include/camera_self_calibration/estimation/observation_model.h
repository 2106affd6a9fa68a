#pragma once

#include <Eigen/Core>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

using Matrix26d = Eigen::Matrix<double, 2, 6>;
using Matrix32d = Eigen::Matrix<double, 3, 2>;

/// Derivatives of a predicted pixel. A pose's six columns are (translation in the world, rotation
/// in the camera): `t <- t + dt`, `R <- R exp(dw)`.
struct PredictionJacobians {
  Matrix26d observing_pose;
  Matrix26d reference_pose;
  Eigen::Vector2d inverse_depth;
  Matrix23d ray;                       ///< In the reference camera.
  PixelIntrinsicsJacobian intrinsics;  ///< Of the projection alone, ray fixed.
};

/// A keyframe's pose as the matrices that the residual is made of.
struct PoseMatrices {
  Eigen::Matrix3d rotation;  ///< world_from_camera
  Eigen::Vector3d position;

  explicit PoseMatrices(const Rigid3& world_from_camera)
      : rotation(world_from_camera.rotation.toRotationMatrix()),
        position(world_from_camera.translation) {}
};

/// The transfer function W of eq. 1, up to the scale that the projection ignores:
/// `x = R_i^T (R_r ray + rho (t_r - t_i))`, `pixel = P(x)`. False where the camera cannot project.
/// `jacobians` may be null; `intrinsics` of it is filled if `with_intrinsics`.
bool predictPixel(const Camera& camera, const PoseMatrices& reference,
                  const PoseMatrices& observing, const Eigen::Vector3d& ray, double inverse_depth,
                  bool with_intrinsics, Eigen::Vector2d* pixel, PredictionJacobians* jacobians);

/// Ray of a landmark in its reference camera: that of the reference pixel, or its bearing. False
/// where the reference pixel has no ray. `d_intrinsics` (may be null) is zero for a bearing.
bool landmarkRay(const Camera& camera, const Landmark& landmark, Eigen::Vector3d* ray,
                 RayIntrinsicsJacobian* d_intrinsics);

/// Two orthonormal directions perpendicular to a unit bearing (columns); a function of the bearing.
Matrix32d tangentBasis(const Eigen::Vector3d& bearing);

}  // namespace camera_self_calibration
