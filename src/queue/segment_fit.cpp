#include "camera_self_calibration/queue/segment_fit.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/estimation/gate.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/solver.h"

namespace camera_self_calibration {
namespace {

// Residual scale of a solved segment against the sigmas that it had before `unexplained` was added.
double scaleAgainstTracker(Segment segment, double unexplained, const Camera& camera) {
  for (Observation& observation : segment.observations) {
    const double square = observation.sigma * observation.sigma - unexplained * unexplained;
    observation.sigma = std::sqrt(std::max(square, 1e-6 * observation.sigma * observation.sigma));
  }
  return medianResidualScale(freeBlock(&segment, camera), camera);
}

}  // namespace

SegmentFitOptions comparableFits() {
  SegmentFitOptions options;
  options.gating_rounds = 0;
  options.max_iterations = 40;
  return options;
}

SegmentFit fitSegment(const SegmentFitOptions& options, Segment* segment, Camera* camera) {
  SegmentFit fit;
  SolverOptions solver;
  solver.max_iterations = options.max_iterations;
  solver.huber = options.huber;
  solver.precision = options.precision;
  solver.intrinsics_precision = options.intrinsics_precision;
  Problem problem;
  problem.camera = camera;
  problem.estimate_intrinsics = options.estimate_intrinsics;
  problem.prior = options.prior;
  // Which tracks are outliers shows well before the solution has settled.
  SolverOptions rough = solver;
  rough.precision = std::max(solver.precision, kRoughPrecision);
  rough.intrinsics_precision = 0.0;
  bool settled = false;
  for (int round = 0; round < options.gating_rounds; ++round) {
    if (segment->observations.empty()) return fit;
    problem.blocks = {freeBlock(segment, *camera)};
    const bool first = round == 0;
    if (!solve(problem, first ? rough : solver).usable) return fit;
    const GateResult gate = gateSegment(problem.blocks.front(), *camera);
    fit.unexplained_sigma = std::hypot(fit.unexplained_sigma, gate.unexplained_sigma);
    if (gate.removed_tracks.empty() && gate.unexplained_sigma == 0.0) {
      settled = !first;
      break;
    }
    fit.removed_tracks.insert(fit.removed_tracks.end(), gate.removed_tracks.begin(),
                              gate.removed_tracks.end());
  }
  if (segment->observations.empty()) return fit;
  problem.blocks = {freeBlock(segment, *camera)};
  if (!settled && !solve(problem, solver).usable) return fit;
  fit.residual_scale = scaleAgainstTracker(*segment, fit.unexplained_sigma, *camera);
  fit.marginal = marginalize(problem, options.huber, 1, options.inverse_depth_noise);
  fit.usable = fit.marginal.information.allFinite();
  return fit;
}

}  // namespace camera_self_calibration
