#pragma once

#include <Eigen/Core>
#include <vector>

#include "camera_self_calibration/estimation/problem.h"

namespace camera_self_calibration {

/// A copy of all that a step of the solver changes; memory is kept from one to the next.
class ProblemState {
 public:
  void save(const Problem& problem);
  void restore(const Problem& problem) const;

 private:
  Camera camera_;
  std::vector<std::vector<Keyframe>> keyframes_;
  std::vector<std::vector<Landmark>> landmarks_;
};

/// Changes a segment's free variables (as LinearSegment orders them).
void applyStep(const SegmentBlock& block, const Eigen::Ref<const Eigen::VectorXd>& own);

/// Turns a landmark's bearing by a step in its tangentBasis().
void turnBearing(const Eigen::Vector2d& step, Landmark* landmark);

/// Changes the intrinsics; false if the camera is then not valid.
bool applyStep(const Intrinsics& step, Camera* camera);

}  // namespace camera_self_calibration
