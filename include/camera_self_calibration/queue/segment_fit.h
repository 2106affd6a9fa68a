#pragma once

#include <cstdint>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

struct SegmentFitOptions {
  bool estimate_intrinsics = true;
  int max_iterations = 20;
  int gating_rounds = 2;           ///< Solve, remove the tracks that do not fit, solve again.
  double huber = kHuberThreshold;  ///< In sigmas.
  /// SolverOptions' of the last solution.
  double precision = kComparisonPrecision;
  double intrinsics_precision = 0.0;
  InverseDepthNoise inverse_depth_noise = InverseDepthNoise::kCounts;  ///< In the marginal.
  IntrinsicsPrior prior = {};  ///< Vague, against runaways; the marginal does not contain it.
};

/// For fits of the same observations under several lenses: nothing is gated, and the effort is the
/// same and enough, so that their costs compare.
SegmentFitOptions comparableFits();

struct SegmentFit {
  bool usable = false;
  Marginal marginal;  ///< At the solution, with the sigmas as they are in the segment then.
  /// Robust scale (medianResidualScale) of the residuals that are left after gating, against the
  /// tracker's own sigmas.
  double residual_scale = 1.0;
  /// Error per axis that was added to the tracker's own sigmas, in quadrature [px].
  double unexplained_sigma = 0.0;
  std::vector<std::int64_t> removed_tracks;
};

/// Solves a segment that conditions on nothing, in place. Between the rounds what the tracker's
/// sigmas do not explain (unexplainedSigma) is added to the observations' sigmas, so that a common
/// misfit empties no segment, and then outliers are removed.
SegmentFit fitSegment(const SegmentFitOptions& options, Segment* segment, Camera* camera);

}  // namespace camera_self_calibration
