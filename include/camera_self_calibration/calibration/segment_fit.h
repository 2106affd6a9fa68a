#pragma once

#include <cstdint>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

struct SegmentFitOptions {
  bool estimate_intrinsics = true;
  int max_iterations = 20;
  int gating_rounds = 2;  ///< Solve, remove the tracks that do not fit, solve again.
  double huber = 2.0;     ///< In sigmas.
  double step_tolerance = 1e-4;
  double cost_tolerance = 1e-7;
};

struct SegmentFit {
  bool usable = false;
  Marginal marginal;  ///< With the tracker's own sigmas.
  /// Robust residual scale before any is put into the sigmas: sqrt(cost per degree of freedom).
  double residual_scale = 1.0;
  std::vector<std::int64_t> removed_tracks;
};

/// Solves a segment that conditions on nothing, gating outliers, in place. The gate widens with the
/// robust residual scale, so that a common misfit (intrinsics still wrong) empties no segment.
SegmentFit fitSegment(const SegmentFitOptions& options, Segment* segment, Camera* camera);

}  // namespace camera_self_calibration
