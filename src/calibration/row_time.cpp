#include "camera_self_calibration/calibration/row_time.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/map/rolling_shutter.h"

namespace camera_self_calibration {
namespace {

// In sigmas: beyond, the shutter rolls without a doubt; and so far the value in use may be off.
constexpr double kSignificant = 5.0;
constexpr double kSmallPart = 0.5;
// Readout times of a whole image [s]: steps of the profile, and what no camera exceeds.
constexpr double kFirstStep = 1e-3;
constexpr double kLeastStep = 5e-5;
constexpr double kLargestStep = 5e-3;
constexpr double kLongest = 0.1;
constexpr double kTypical = 0.02;  // where the shutter rolls, as half of all do

struct Solved {
  bool usable = false;
  double cost = 0.0;
  Camera camera;
};

Solved solveWith(double row_time_s, const std::vector<SegmentBlock>& blocks, const Camera& camera,
                 const IntrinsicsPrior& prior, int threads) {
  Solved solved;
  solved.camera = camera;
  std::vector<Segment> segments;
  for (const SegmentBlock& block : blocks) segments.push_back(*block.segment);
  Problem problem{&solved.camera, true, blocks, prior};
  for (std::size_t i = 0; i < segments.size(); ++i) {
    setRowTimeOfScene(row_time_s, camera, &segments[i]);
    problem.blocks[i].segment = &segments[i];
  }
  SolverOptions options;
  options.threads = threads;
  options.max_iterations = 15;
  options.step_tolerance = 1e-2;
  options.cost_tolerance = 1e-5;  // of the three alike: a hundredth of their differences
  const SolveSummary summary = solve(problem, options);
  solved.usable = summary.usable && solved.camera.valid();
  solved.cost = summary.final_cost;
  return solved;
}

}  // namespace

RowTimeEstimate estimateRowTime(const std::vector<SegmentBlock>& blocks, const Camera& camera,
                                const IntrinsicsPrior& prior, double step_s, int threads) {
  RowTimeEstimate estimate;
  if (blocks.empty() || blocks.front().segment->keyframes.empty()) return estimate;
  const double present = blocks.front().segment->keyframes.front().row_time_s;
  std::array<Solved, 3> at;
  for (int i = 0; i < 3; ++i) {
    at[i] = solveWith(present + (i - 1) * step_s, blocks, camera, prior, threads);
    if (!at[i].usable) return estimate;
  }
  const double bend = (at[0].cost - 2.0 * at[1].cost + at[2].cost) / (step_s * step_s);
  const double slope = (at[2].cost - at[0].cost) / (2.0 * step_s);
  if (!(bend > 0.0) || !std::isfinite(bend) || !std::isfinite(slope)) return estimate;
  estimate.usable = true;
  estimate.row_time_s = present - slope / bend;
  estimate.sigma_s = 1.0 / std::sqrt(bend);
  const int count = camera.estimatedCount();
  estimate.slope =
      (at[2].camera.parameters() - at[0].camera.parameters()).head(count) / (2.0 * step_s);
  return estimate;
}

Candidate withRowTime(const Candidate& candidate, double row_time_s, const Camera& start) {
  Segment segment = candidate.observed.keyframes.empty() ? candidate.segment : candidate.observed;
  if (segment.keyframes.empty() || segment.keyframes.front().row_time_s == row_time_s) {
    return candidate;
  }
  setRowTimeOfScene(row_time_s, start, &segment);
  return evaluateCandidate(CandidateOptions(), segment, start);
}

bool RowTime::take(const RowTimeEstimate& estimate) {
  if (!estimate.usable || !(std::abs(estimate.row_time_s) < kLongest / row_steps_)) return false;
  estimate_ = estimate;
  const bool rolls = std::abs(estimate.row_time_s) > kSignificant * estimate.sigma_s;
  const double wanted = rolls ? estimate.row_time_s : 0.0;
  settled_ = std::abs(wanted - in_use_s_) <= kSmallPart * estimate.sigma_s;
  if (settled_) return false;
  in_use_s_ = wanted;
  return true;
}

double RowTime::doubt() const {
  if (!estimate_.usable) return 0.0;
  const double variance = estimate_.sigma_s * estimate_.sigma_s;
  if (in_use_s_ != 0.0) return estimate_.sigma_s;
  const double prior = (kTypical / row_steps_) * (kTypical / row_steps_);
  const double square = estimate_.row_time_s * estimate_.row_time_s;
  // Likelihood of the estimate where the shutter rolls over that where it does not, and the mean
  // square of the row time where it does.
  const double ratio = std::sqrt(variance / (variance + prior)) *
                       std::exp(0.5 * square * (1.0 / variance - 1.0 / (variance + prior)));
  const double share = prior / (prior + variance);
  const double mean_square = share * share * square + share * variance;
  return std::sqrt(mean_square * (1.0 - 1.0 / (1.0 + ratio)));
}

double RowTime::step() const {
  if (!estimate_.usable) return kFirstStep / row_steps_;
  return std::clamp(2.0 * estimate_.sigma_s, kLeastStep / row_steps_, kLargestStep / row_steps_);
}

}  // namespace camera_self_calibration
