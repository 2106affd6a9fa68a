#pragma once

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/problem.h"
#include "camera_self_calibration/estimation/robust.h"

namespace camera_self_calibration {

struct LandmarkSolverOptions {
  int max_evaluations = 10;        ///< Of a landmark's residuals, after the first.
  double huber = kHuberThreshold;  ///< As SolverOptions::huber.
  double precision = 1e-6;         ///< A landmark rests when a step is shorter than this [sigma].
};

/// The landmarks alone (eq. 2), all poses and the intrinsics held: each by itself, Gauss-Newton
/// steps that are shortened where they do not lower its cost. What solve() gives where all
/// keyframes are fixed, but one landmark that does not fit holds up no other. Of the block the
/// segment and `sigma_scale` count. A landmark that nothing determines stays as it is.
void solveLandmarks(const SegmentBlock& block, const Camera& camera,
                    const LandmarkSolverOptions& options);

}  // namespace camera_self_calibration
