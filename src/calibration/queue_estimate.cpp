#include "camera_self_calibration/calibration/queue_estimate.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/linear_segment.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/solver.h"

namespace camera_self_calibration {

void QueueEstimate::remove(const std::vector<std::int64_t>& sequences) {
  const auto leaves = [&](const Candidate& candidate) {
    return std::find(sequences.begin(), sequences.end(), candidate.segment.sequence) !=
           sequences.end();
  };
  candidates_.erase(std::remove_if(candidates_.begin(), candidates_.end(), leaves),
                    candidates_.end());
}

QueueSolution QueueEstimate::solve(const Camera& start) {
  QueueSolution solution;
  solution.camera = start;
  if (candidates_.empty()) return solution;
  Problem problem;
  problem.camera = &solution.camera;
  for (Candidate& candidate : candidates_) {
    problem.blocks.push_back(freeBlock(&candidate.segment, start));
    problem.blocks.back().sigma_scale = candidate.sigma_scale;
  }
  SolverOptions options;
  options.threads = threads_;
  options.max_iterations = 20;
  // From warm starts: what is left is the slow settling of outlying tracks, far below a tenth of the
  // intrinsics' sigma.
  options.step_tolerance = 1e-2;
  options.cost_tolerance = 2e-6;
  const SolveSummary summary = camera_self_calibration::solve(problem, options);
  solution.iterations = summary.iterations;
  double chi_square = 0.0;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const double joint = robustCost(problem.blocks[i], solution.camera, options.huber);
    chi_square += std::max(0.0, 2.0 * (joint - candidates_[i].cost));
  }
  const int freedom = (static_cast<int>(candidates_.size()) - 1) * problem.intrinsicsCount();
  // One segment alone cannot disagree: what was known of disagreement stays.
  if (freedom > 0) inflation_ = std::sqrt(std::max(1.0, chi_square / freedom));
  solution.inflation = inflation_;
  const double variance = solution.inflation * solution.inflation;
  const Marginal marginal = marginalize(problem, options.huber, threads_);
  solution.information = marginal.information / variance;
  if (const auto covariance = marginal.robustCovariance()) {
    solution.covariance = variance * *covariance;
  }
  solution.usable = summary.usable && solution.camera.valid() && solution.covariance.size() > 0;
  return solution;
}

}  // namespace camera_self_calibration
