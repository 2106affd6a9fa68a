#include "camera_self_calibration/calibration/segment_fit.h"

#include <algorithm>

#include "camera_self_calibration/estimation/gate.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/solver.h"

namespace camera_self_calibration {

SegmentFit fitSegment(const SegmentFitOptions& options, Segment* segment, Camera* camera) {
  SegmentFit fit;
  SolverOptions solver;
  solver.max_iterations = options.max_iterations;
  solver.huber = options.huber;
  solver.step_tolerance = options.step_tolerance;
  solver.cost_tolerance = options.cost_tolerance;
  Problem problem;
  problem.camera = camera;
  problem.estimate_intrinsics = options.estimate_intrinsics;
  for (int round = 0;; ++round) {
    if (segment->observations.empty()) return fit;
    problem.blocks = {freeBlock(segment, *camera)};
    if (!solve(problem, solver).usable) return fit;
    if (round == options.gating_rounds) break;
    SegmentBlock scaled = problem.blocks.front();
    scaled.sigma_scale = std::max(1.0, medianResidualScale(scaled, *camera));
    const std::vector<int> outliers = misfits(scaled, *camera);
    if (outliers.empty()) break;
    for (const int l : outliers) fit.removed_tracks.push_back(segment->landmarks[l].track_id);
    removeLandmarks(outliers, segment);
  }
  fit.marginal = marginalize(problem, options.huber);
  fit.residual_scale = fit.marginal.residualScale();
  fit.usable = fit.marginal.information.allFinite();
  return fit;
}

}  // namespace camera_self_calibration
