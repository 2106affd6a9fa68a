#include "camera_self_calibration/estimation/observation_model.h"

namespace camera_self_calibration {

bool predictPixel(const Camera& camera, const PoseMatrices& reference,
                  const PoseMatrices& observing, const Eigen::Vector3d& ray, double inverse_depth,
                  bool with_intrinsics, Eigen::Vector2d* pixel, PredictionJacobians* jacobians) {
  const Eigen::Vector3d baseline = reference.position - observing.position;
  const Eigen::Vector3d world_ray = reference.rotation * ray;
  // Eq. (1)
  const Eigen::Vector3d point =
      observing.rotation.transpose() * (world_ray + inverse_depth * baseline);
  if (jacobians == nullptr) return camera.project(point, pixel);
  Matrix23d d_point;
  if (!camera.project(point, pixel, &d_point, with_intrinsics ? &jacobians->intrinsics : nullptr)) {
    return false;
  }
  const Matrix23d d_world = d_point * observing.rotation.transpose();
  jacobians->ray.noalias() = d_world * reference.rotation;
  jacobians->inverse_depth.noalias() = d_world * baseline;
  jacobians->observing_pose.leftCols<3>() = -inverse_depth * d_world;
  jacobians->reference_pose.leftCols<3>() = inverse_depth * d_world;
  // Row by row, a^T skew(b) = (a x b)^T.
  for (int row = 0; row < 2; ++row) {
    jacobians->observing_pose.row(row).tail<3>() =
        d_point.row(row).transpose().cross(point).transpose();
    jacobians->reference_pose.row(row).tail<3>() =
        ray.cross(jacobians->ray.row(row).transpose()).transpose();
  }
  return true;
}

bool landmarkRay(const Camera& camera, const Landmark& landmark, Eigen::Vector3d* ray,
                 RayIntrinsicsJacobian* d_intrinsics) {
  if (landmark.anchored) return camera.unproject(landmark.reference_pixel, ray, d_intrinsics);
  *ray = landmark.bearing;
  if (d_intrinsics != nullptr) d_intrinsics->setZero(3, camera.parameterCount());
  return true;
}

Matrix32d tangentBasis(const Eigen::Vector3d& bearing) {
  // The coordinate axis furthest from the bearing keeps the cross product well conditioned.
  int axis = 0;
  bearing.cwiseAbs().minCoeff(&axis);
  Matrix32d basis;
  basis.col(0) = bearing.cross(Eigen::Vector3d::Unit(axis)).normalized();
  basis.col(1) = bearing.cross(basis.col(0));
  return basis;
}

}  // namespace camera_self_calibration
