#pragma once

#include <ceres/cost_function.h>

#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/reference/residuals.h"

namespace camera_self_calibration {

// Eq. (2) whitened, for a camera of a rig: that of InheritedResidual with the cameras' poses
// `world_from_rig * rig_from_camera`, and the landmark in a chart about a base bearing b:
// (u, v, rho), with the unit bearing along `b + B (u, v)`, B its tangent basis.
// Parameter blocks: for each different pose in `roles` two blocks, q (x y z w) and t, in the order
// of their numbers; then the landmark and the intrinsics.
class RigResidual : public ceres::CostFunction {
 public:
  // Which pose stands where, as numbers 0, 1, ... A pose may have several roles. kNone: the
  // identity, as the rig's pose where both images were taken at once.
  struct Roles {
    static constexpr int kNone = -1;
    int observing_rig = kNone;
    int observing_camera = kNone;
    int reference_rig = kNone;
    int reference_camera = kNone;
    int count = 0;  // Of different poses.
  };

  RigResidual(const Camera& camera, const Roles& roles, const Eigen::Vector3d& base_bearing,
              const Eigen::Vector2d& pixel, double sigma);
  bool Evaluate(double const* const* parameters, double* residual,
                double** jacobians) const override;

 private:
  InheritedResidual inner_;
  Roles roles_;
  Eigen::Vector3d base_;
  Matrix32d tangent_;
};

}  // namespace camera_self_calibration
