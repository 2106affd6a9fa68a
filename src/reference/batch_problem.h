#pragma once

#include <ceres/problem.h>

#include <vector>

#include "camera_self_calibration/reference/batch.h"

namespace camera_self_calibration {

// The Ceres problem over the memory of the segments and a copy of the intrinsics. One residual
// block an observation, in their order.
class BatchProblem {
 public:
  BatchProblem(const std::vector<BatchSegment>& segments, const Camera& camera,
               const BatchOptions& options);

  ceres::Problem* problem() { return &problem_; }
  const Intrinsics& intrinsics() const { return intrinsics_; }
  bool usesIntrinsics() const { return problem_.HasParameterBlock(intrinsics_.data()); }

  // The blocks that are not held, the intrinsics last.
  std::vector<double*> freeBlocks();

 private:
  void addResiduals(const BatchSegment& batch);
  void add(ceres::CostFunction* cost, const std::vector<double*>& blocks);
  void constrain(const BatchSegment& batch);
  void constrainIntrinsics();
  void fix(double* block) {
    if (problem_.HasParameterBlock(block)) problem_.SetParameterBlockConstant(block);
  }

  Camera camera_;
  Intrinsics intrinsics_;
  BatchOptions options_;
  ceres::Problem problem_;
};

}  // namespace camera_self_calibration
