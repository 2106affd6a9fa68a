#pragma once

#include <ceres/problem.h>

#include <array>
#include <vector>

#include "camera_self_calibration/rig/rig_solver.h"
#include "rig_residual.h"

namespace camera_self_calibration {

// The Ceres problem over the poses of segments and rig, with the landmarks in charts of their own.
// One residual block an observation: by segment, camera, and in their order.
class RigProblem {
 public:
  RigProblem(const RigSolveOptions& options, std::vector<RigSegment>* segments, Rig* rig);

  ceres::Problem* problem() { return &problem_; }
  bool empty() const { return problem_.NumResidualBlocks() == 0; }

  // Writes landmarks and intrinsics back; poses are where they belong already.
  void takeOver();

  // The blocks that are not held; those of RigLayout last, in its order.
  std::vector<double*> freeBlocks();
  // Of the latter.
  int sharedSize();
  // Of each residual block, the landmark that it belongs to.
  const std::vector<int>& clusters() const { return clusters_; }

 private:
  using Chart = std::array<double, 3>;

  void toFirstFrame(RigSegment* segment);
  void addTracks(RigSegment* segment, int camera, std::vector<Chart>* charts);
  void addObservation(RigSegment* segment, const Observation& seen, const Landmark& landmark,
                      Chart* chart);
  void holdFirst(RigSegment* segment);
  void holdScale(RigSegment* segment);
  void constrainRig();
  bool shared(const double* block) const;

  RigSolveOptions options_;
  std::vector<RigSegment>* segments_;
  Rig* rig_;
  std::vector<Intrinsics> intrinsics_;
  std::vector<std::vector<std::vector<Chart>>> charts_;  // of each segment and camera
  std::vector<int> clusters_;
  int landmarks_ = 0;
  ceres::Problem problem_;
};

}  // namespace camera_self_calibration
