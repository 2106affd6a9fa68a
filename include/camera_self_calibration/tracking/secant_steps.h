#pragma once

#include <Eigen/Core>

#include "camera_self_calibration/tracking/reference_patch.h"

namespace camera_self_calibration {

/// A step of the affine warp: shift, then linear part by columns.
using WarpStep = Eigen::Matrix<double, ReferencePatch::kWarp, 1>;

/// Lengthens the steps of a registration. Gauss-Newton overestimates the curvature where the
/// gradients of the reference are noisy or the image has become blurred: its steps then stay short,
/// and many are needed. Broyden's update of the inverse Jacobian of the step (Broyden 1965, the
/// good one) learns from two steps by how much.
class SecantSteps {
 public:
  /// The step to take where Gauss-Newton proposes `proposed`.
  WarpStep next(const WarpStep& proposed);

 private:
  void learn(const WarpStep& proposed);

  bool started_ = false;
  Eigen::Matrix<double, ReferencePatch::kWarp, ReferencePatch::kWarp> inverse_;
  WarpStep last_proposed_;
  WarpStep last_taken_;
};

}  // namespace camera_self_calibration
