#pragma once

#include "camera_self_calibration/estimation/problem.h"
#include "camera_self_calibration/estimation/robust.h"

namespace camera_self_calibration {

/// How far from its optimum a solution may end [sigma]: SolverOptions::precision. Of a step on the
/// way, which gating, another keyframe or another iteration follows: outlying tracks, which are
/// removed, settle last.
constexpr double kRoughPrecision = 0.1;
/// Of a solution whose intrinsics are used: even what all the variables have left to go in common
/// is far below a sigma of the intrinsics.
constexpr double kEstimatePrecision = 5e-3;
/// Of solutions whose costs are compared, by a likelihood ratio of the order of one: of a cost of
/// several thousand less than a hundredth is left.
constexpr double kComparisonPrecision = 1e-3;

struct SolverOptions {
  int max_iterations = 30;
  /// Huber threshold on the norm of a whitened residual; <= 0: least squares.
  double huber = kHuberThreshold;
  /// In standard deviations. Ends when a step is shorter than this, in conditional ones (1 / column
  /// norm of J, at most the marginal one), or when it lowers the cost by less than a share
  /// precision^2: a move of n variables by s sigma each gains n s^2 / 2, and N residuals of unit
  /// variance cost N / 2, so that s = precision sqrt(N / n).
  double precision = 1e-6;
  /// Ends after a full Gauss-Newton step that leaves the intrinsics, going by how fast such steps
  /// shrink, less than this many of their marginal standard deviations to go, all together. 0: of
  /// no account.
  double intrinsics_precision = 0.0;
  int threads = 1;  ///< For the segments; the result does not depend on it.
};

struct SolveSummary {
  bool usable = false;     ///< The state is finite and no worse than at the start.
  bool converged = false;  ///< To one of the precisions.
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;  ///< Sum of huberCost over all observations.
};

/// Minimises eq. 3 over the problem's poses, landmarks and intrinsics, in place: dog-leg trust
/// region (section II-A) in variables scaled to unit columns of J, nested elimination (landmarks,
/// poses of each segment, intrinsics). An empty or unobservable problem changes nothing that it
/// cannot estimate.
SolveSummary solve(const Problem& problem, const SolverOptions& options);

}  // namespace camera_self_calibration
