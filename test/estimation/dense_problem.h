#pragma once

#include <Eigen/Core>

#include "camera_self_calibration/estimation/linear_segment.h"
#include "camera_self_calibration/estimation/problem.h"

namespace camera_self_calibration {

/// One segment with the intrinsics, written down without any structure: all variables in one vector
/// (free poses, landmarks, intrinsics), every residual predicted from eq. 1 in the plainest way,
/// and derivatives by central differences. What the estimation room does cleverly is compared with
/// it.
class DenseProblem {
 public:
  DenseProblem(const SegmentBlock& block, const Camera& camera, int intrinsics_count);

  int variables() const { return poses_ + landmarks_ + intrinsics_; }

  /// Whitened r = z - W of the state moved by `step`, two rows an observation.
  Eigen::VectorXd residuals(const Eigen::VectorXd& step) const;
  /// Robust cost of the state moved by `step`.
  double cost(const Eigen::VectorXd& step, double huber) const;
  /// J = dW/dx by central differences.
  Eigen::MatrixXd jacobian() const;
  /// sqrt of Huber's weight of each row.
  Eigen::VectorXd rootWeights(double huber) const;

  /// The step's parts as the estimation room wants them.
  Eigen::VectorXd ownStep(const Eigen::VectorXd& step) const {
    return step.head(poses_ + landmarks_);
  }
  Intrinsics intrinsicsStep(const Eigen::VectorXd& step) const { return step.tail(intrinsics_); }
  Eigen::VectorXd join(const Eigen::VectorXd& own, const Intrinsics& intrinsics) const {
    Eigen::VectorXd step(variables());
    step << own, intrinsics;
    return step;
  }

  /// Size of a step in each variable that changes pixels by the order of one.
  Eigen::VectorXd stepSizes() const;

 private:
  Eigen::Vector2d predict(const Segment& segment, const Camera& camera,
                          const Observation& observation) const;
  void move(const Eigen::VectorXd& step, Segment* segment, Camera* camera) const;

  SegmentBlock block_;
  Camera camera_;
  int poses_ = 0;
  int landmarks_ = 0;
  int intrinsics_ = 0;
};

}  // namespace camera_self_calibration
