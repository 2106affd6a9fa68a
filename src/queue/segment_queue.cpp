#include "camera_self_calibration/queue/segment_queue.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/map/segment_edit.h"
#include "camera_self_calibration/queue/agreement.h"

namespace camera_self_calibration {

namespace {

constexpr int kSettlingRounds = 2;
constexpr double kSettled = 0.02;  // of the intrinsics' sigmas, in a step
// Of a segment's cost: beyond its share it is unsettled; a tenth of that is not worth a solution.
constexpr double kUnsettledShare = 0.02;
constexpr double kSettledShare = 0.1 * kUnsettledShare;

SolverOptions solverOptions(int threads) {
  SolverOptions options;
  options.threads = threads;
  options.max_iterations = 20;
  options.precision = kEstimatePrecision;
  options.intrinsics_precision = kSettled;
  return options;
}

// How far a segment's own estimate is from the joint one: twice the rise of its cost, measured and
// to second order.
struct Disagreement {
  double measured = 0.0;
  double expected = 0.0;

  double chiSquare() const { return std::max(0.0, std::min(measured, expected)); }
  // Poses and depths are where they explain the segment far worse than they could with the joint
  // intrinsics. A segment whose own cost says nothing about them is taken as it is.
  bool unsettled(double own_cost) const {
    return measured > 2.0 * expected + 10.0 + kUnsettledShare * own_cost;
  }
};

Disagreement disagreement(const Candidate& candidate, const SegmentBlock& block,
                          const Camera& joint) {
  const Intrinsics off =
      (joint.parameters() - candidate.camera.parameters()).head(candidate.information.rows());
  const double cost = robustCost(block, joint, SolverOptions().huber);
  return {2.0 * (cost - candidate.cost), off.dot(candidate.information * off)};
}

SegmentScore scoreOf(const Candidate& candidate) {
  SegmentScore score;
  score.sequence = candidate.segment.sequence;
  score.begin_ns = candidate.segment.beginNs();
  score.end_ns = candidate.segment.endNs();
  score.entropy = candidate.entropy;
  score.pixel_rms = candidate.uncertainty.rms;
  score.information = candidate.information;
  score.well_posed = candidate.well_posed;
  return score;
}

}  // namespace

QueueDecision SegmentQueue::consider(const SegmentScore& candidate, const Camera& camera) const {
  std::vector<SegmentScore> scores;
  for (const Candidate& segment : candidates_) scores.push_back(scoreOf(segment));
  return policy_.consider(candidate, scores, camera, filling_);
}

QueueDecision SegmentQueue::take(const Candidate& candidate) {
  QueueDecision decision = consider(scoreOf(candidate), candidate.camera);
  if (!candidate.well_posed) decision.reason = "refused: " + candidate.reason;
  if (!decision.accepted) return decision;
  remove(decision.replaced);
  candidates_.push_back(candidate);
  own_.push_back(candidate.segment);
  return decision;
}

QueueDecision SegmentQueue::offer(const Candidate& candidate, const QueueStart& start) {
  const QueueDecision decision = take(candidate);
  if (decision.accepted) solve(start);
  return decision;
}

int SegmentQueue::takeAll(const std::vector<Candidate>& candidates) {
  int taken = 0;
  for (const Candidate& candidate : candidates) taken += take(candidate).accepted;
  return taken;
}

int SegmentQueue::offer(const std::vector<Candidate>& candidates, const QueueStart& start) {
  const int taken = takeAll(candidates);
  if (taken > 0) solve(start);
  return taken;
}

int SegmentQueue::exchange(const std::vector<std::int64_t>& leaving,
                           const std::vector<Candidate>& candidates, const QueueStart& start) {
  remove(leaving);
  const int taken = takeAll(candidates);
  solve(start);
  return taken;
}

int SegmentQueue::rebuild(const std::vector<Candidate>& candidates, const QueueStart& start) {
  clear();
  return exchange({}, candidates, start);
}

void SegmentQueue::clear() {
  candidates_.clear();
  own_.clear();
  scatter_ = Scatter();
  solution_ = QueueSolution();
}

void SegmentQueue::remove(const std::vector<std::int64_t>& sequences) {
  const auto leaves = [&](const Candidate& candidate) {
    return std::find(sequences.begin(), sequences.end(), candidate.segment.sequence) !=
           sequences.end();
  };
  for (std::size_t i = candidates_.size(); i-- > 0;) {
    if (!leaves(candidates_[i])) continue;
    candidates_.erase(candidates_.begin() + static_cast<std::ptrdiff_t>(i));
    own_.erase(own_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

// In a segment that hardly tells poses or depths, as in rotation on the spot, a joint step can
// throw them where no later step leads back from, and the segment would seem to disagree with the
// rest. From the solution that it came with, the way is short.
bool SegmentQueue::settle(Problem* problem) {
  bool moved = false;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    SegmentBlock& block = problem->blocks[i];
    const Disagreement now = disagreement(candidates_[i], block, *problem->camera);
    if (!now.unsettled(candidates_[i].cost)) continue;
    Segment again = restarted(candidates_[i].segment, own_[i]);
    Problem alone{problem->camera, false, {block}, {}};
    alone.blocks[0].segment = &again;
    SolverOptions options = solverOptions(1);
    options.precision = std::sqrt(kSettledShare);
    if (!camera_self_calibration::solve(alone, options).usable) continue;
    const Disagreement then = disagreement(candidates_[i], alone.blocks[0], *problem->camera);
    if (then.measured < now.measured - kSettledShare * candidates_[i].cost) {
      candidates_[i].segment = std::move(again);
      moved = true;
    }
  }
  return moved;
}

void SegmentQueue::solve(const QueueStart& start) {
  solution_ = QueueSolution();
  solution_.camera = start.camera;
  if (candidates_.empty()) return;
  Problem problem;
  problem.camera = &solution_.camera;
  for (Candidate& candidate : candidates_) {
    problem.blocks.push_back(freeBlock(&candidate.segment, start.camera));
    problem.blocks.back().sigma_scale = candidate.sigma_scale;
  }
  const SolverOptions options = solverOptions(threads_);
  SolveSummary summary = camera_self_calibration::solve(problem, options);
  solution_.iterations = summary.iterations;
  for (int round = 0; round < kSettlingRounds && summary.usable && settle(&problem); ++round) {
    summary = camera_self_calibration::solve(problem, options);
    solution_.iterations += summary.iterations;
  }
  setCovariance(problem);
  solution_.usable = summary.usable && solution_.camera.valid() && solution_.covariance.size() > 0;
  solution_.addUncertaintyOf(start.line_delay, start.line_delay_doubt_s);
}

// Of a problem at its optimum.
void SegmentQueue::setCovariance(const Problem& problem) {
  double chi_square = 0.0;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    chi_square += disagreement(candidates_[i], problem.blocks[i], solution_.camera).chiSquare();
  }
  const int freedom = (static_cast<int>(candidates_.size()) - 1) * problem.intrinsicsCount();
  // One segment alone cannot disagree: what was known of disagreement stays.
  if (freedom > 0) scatter_ = {chi_square, freedom};
  solution_.scatter = scatter_;
  const double ratio = solution_.scatter.birgeRatio();
  const double variance = ratio * ratio;
  Marginal marginal =
      marginalize(problem, solverOptions(threads_).huber, threads_, InverseDepthNoise::kDiscounted);
  solution_.information = marginal.whole_information / variance;
  if (const auto covariance = marginal.robustCovariance()) {
    solution_.covariance = variance * *covariance;
  }
  solution_.shares = std::move(marginal.shares);
}

LineDelayEstimate SegmentQueue::lineDelay() const {
  std::vector<Segment> segments;
  for (const Candidate& candidate : candidates_) segments.push_back(candidate.segment);
  std::vector<SegmentBlock> blocks;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    blocks.push_back(freeBlock(&segments[i], solution_.camera));
    blocks.back().sigma_scale = candidates_[i].sigma_scale * solution_.scatter.birgeRatio();
  }
  return estimateLineDelay(blocks, solution_.camera, IntrinsicsPrior(), threads_);
}

}  // namespace camera_self_calibration
