#pragma once

#include "camera_self_calibration/estimation/problem.h"
#include "camera_self_calibration/estimation/robust.h"

namespace camera_self_calibration {

struct SolverOptions {
  int max_iterations = 30;
  /// Huber threshold on the norm of a whitened residual; <= 0: least squares.
  double huber = kHuberThreshold;
  /// Ends when no variable moves by more than this many of its conditional standard deviations
  /// (1 / column norm of J, at most its marginal one).
  double step_tolerance = 1e-6;
  /// Ends when a step lowers the cost by less than this share of it.
  double cost_tolerance = 1e-12;
  /// Ends after a full Gauss-Newton step that leaves the intrinsics, going by how fast such steps
  /// shrink, less than this many of their marginal standard deviations to go, all together. 0: of
  /// no account.
  double intrinsics_tolerance = 0.0;
  int threads = 1;  ///< For the segments; the result does not depend on it.
};

struct SolveSummary {
  bool usable = false;     ///< The state is finite and no worse than at the start.
  bool converged = false;  ///< One of the tolerances was met.
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
