#include "camera_self_calibration/estimation/solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "camera_self_calibration/base/parallel.h"
#include "camera_self_calibration/estimation/linear_segments.h"
#include "camera_self_calibration/estimation/pseudo_inverse.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "camera_self_calibration/estimation/transfer.h"
#include "dog_leg_path.h"
#include "problem_state.h"

namespace camera_self_calibration {
namespace {

constexpr double kInitialRadius = 1e4;
constexpr double kMinRadius = 1e-12;
constexpr double kMinDamping = 1e-10;
constexpr double kMaxDamping = 1.0;

// Steps and gradients are vectors of all variables: the intrinsics, then each segment's own.
class DogLeg {
 public:
  DogLeg(const Problem& problem, const SolverOptions& options)
      : problem_(problem),
        options_(options),
        blocks_(static_cast<int>(problem.blocks.size())),
        count_(problem.intrinsicsCount()),
        linear_(problem.blocks.size()),
        segments_(problem.blocks.size()) {}

  SolveSummary run();

 private:
  struct SegmentWork {
    Transfers transfers;
    double cost = 0.0;
    int begin = 0;  // of its variables
  };

  template <typename Vector>
  auto ownPart(int i, Vector* all) const {
    return all->segment(segments_[i].begin, linear_[i].variables());
  }

  void linearize();
  void gather();
  bool gaussNewton();
  bool reduce();
  bool makePath();
  void makeCauchyStep();
  double curvature(const Eigen::VectorXd& step) const;
  void propose();
  double apply();
  double intrinsicsToGo() const;
  bool negligible(double gain) const {
    return gain < options_.precision * options_.precision * cost_;
  }
  void tryStep(SolveSummary* summary);

  const Problem problem_;
  const SolverOptions options_;
  const int blocks_;
  const int count_;
  double damping_ = kMinDamping;
  double radius_ = kInitialRadius;

  LinearSegments linear_;
  std::vector<SegmentWork> segments_;
  ProblemState saved_;
  double cost_ = 0.0;
  bool linearized_ = false;  // at the present state
  bool finite_ = false;      // what came of it
  Eigen::VectorXd gradient_;
  Eigen::VectorXd scale_;  // column norms of J
  PseudoInverse reduced_inverse_;

  // The path from the present state.
  bool has_path_ = false;
  Eigen::VectorXd newton_;
  double newton_norm_ = 0.0;           // scaled
  double intrinsics_step_ = 0.0;       // of newton_, in marginal standard deviations
  double last_intrinsics_step_ = 0.0;  // taken in full; 0: none
  bool has_cauchy_ = false;
  Eigen::VectorXd cauchy_;

  // What is tried of it.
  Eigen::VectorXd step_;
  double step_norm_ = 0.0;  // scaled
  double predicted_gain_ = 0.0;
};

void DogLeg::linearize() {
  parallelFor(options_.threads, blocks_, [this](int i) {
    LinearSegment& linear = linear_[i];
    if (gradient_.size() == 0) {
      linear.linearize(problem_.blocks[i], *problem_.camera, count_, options_.huber);
    } else {
      linear.relinearize(problem_.blocks[i], *problem_.camera, options_.huber);
    }
    linear.eliminate(damping_);
  });
  int begin = count_;
  for (int i = 0; i < blocks_; ++i) {
    segments_[i].begin = begin;
    begin += linear_[i].variables();
  }
  gradient_.resize(begin);
  scale_.resize(begin);
  gather();
  linearized_ = true;
}

// The segments' gradients and column norms, in their fixed order.
void DogLeg::gather() {
  const Intrinsics& parameters = problem_.camera->parameters();
  cost_ = problem_.prior.cost(parameters, count_);
  gradient_.head(count_) = problem_.prior.gradient(parameters, count_);
  scale_.head(count_) = problem_.prior.information(parameters, count_).diagonal();
  for (int i = 0; i < blocks_; ++i) {
    const LinearSegment& linear = linear_[i];
    cost_ += linear.cost();
    gradient_.head(count_) += linear.intrinsicsGradient();
    scale_.head(count_) += linear.intrinsicsDiagonal();
    linear.copyGradient(ownPart(i, &gradient_));
    linear.copyDiagonal(ownPart(i, &scale_));
  }
  // A column without information has no gradient either: any positive scale serves.
  finite_ = std::isfinite(cost_) && gradient_.allFinite() && scale_.allFinite();
  scale_ = scale_.unaryExpr([](double s) { return s > 0.0 ? std::sqrt(s) : 1.0; }).eval();
}

// The intrinsics' part of the Gauss-Newton step.
bool DogLeg::reduce() {
  if (count_ == 0) return true;
  const Intrinsics& parameters = problem_.camera->parameters();
  Eigen::MatrixXd reduced = problem_.prior.information(parameters, count_);
  Eigen::VectorXd right = problem_.prior.gradient(parameters, count_);
  for (int i = 0; i < blocks_; ++i) {
    reduced += linear_[i].reducedHessian();
    right += linear_[i].reducedGradient();
  }
  if (!reduced.allFinite()) return false;
  reduced_inverse_.compute(reduced, LinearSegment::kRankTolerance);
  newton_.head(count_) = reduced_inverse_.solve(right);
  intrinsics_step_ = std::sqrt(std::max(0.0, right.dot(newton_.head(count_))));
  return true;
}

bool DogLeg::gaussNewton() {
  newton_.resize(gradient_.size());
  if (!reduce()) return false;
  const Intrinsics intrinsics = newton_.head(count_);
  parallelFor(options_.threads, blocks_,
              [&](int i) { linear_[i].backSubstitute(intrinsics, ownPart(i, &newton_)); });
  newton_norm_ = newton_.cwiseProduct(scale_).norm();
  return std::isfinite(newton_norm_);
}

// The Gauss-Newton end of the dog-leg path at the present state; false where there is none. No
// damping helps where the derivatives overflow.
bool DogLeg::makePath() {
  if (!linearized_) linearize();
  if (!finite_) return false;
  while (!gaussNewton()) {
    damping_ *= 10.0;
    if (damping_ >= kMaxDamping) return false;
    parallelFor(options_.threads, blocks_, [this](int i) { linear_[i].eliminate(damping_); });
  }
  has_path_ = true;
  has_cauchy_ = false;
  return true;
}

double DogLeg::curvature(const Eigen::VectorXd& step) const {
  const Intrinsics intrinsics = step.head(count_);
  double sum = intrinsics.dot(problem_.prior.information(problem_.camera->parameters(), count_) *
                              intrinsics);
  for (int i = 0; i < blocks_; ++i) {
    sum += linear_[i].curvature(ownPart(i, &step), step.head(count_));
  }
  return sum;
}

// Steepest descent in the scaled variables, to the minimum of the quadratic model: D^-2 b. Of the
// full J, never of the reduced system.
void DogLeg::makeCauchyStep() {
  cauchy_ = gradient_.cwiseQuotient(scale_.cwiseAbs2());
  const double steepness = cauchy_.dot(gradient_);
  const double bend = curvature(cauchy_);
  cauchy_ *= bend > 0.0 ? steepness / bend : 0.0;
  has_cauchy_ = true;
}

// The longest step along the path within the trust region.
void DogLeg::propose() {
  if (newton_norm_ <= radius_) {
    step_ = newton_;
    step_norm_ = newton_norm_;
    // s^T H s = s^T b - damping |D s|^2, as s solves the damped equations.
    predicted_gain_ = 0.5 * (gradient_.dot(newton_) + damping_ * newton_norm_ * newton_norm_);
    return;
  }
  if (!has_cauchy_) makeCauchyStep();
  step_ = dogLegPoint(newton_, cauchy_, scale_, radius_);
  step_norm_ = step_.cwiseProduct(scale_).norm();
  predicted_gain_ = gradient_.dot(step_) - 0.5 * curvature(step_);
}

// Returns the cost there.
double DogLeg::apply() {
  if (!applyStep(Intrinsics(step_.head(count_)), problem_.camera)) {
    return std::numeric_limits<double>::infinity();
  }
  parallelFor(options_.threads, blocks_, [this](int i) {
    applyStep(problem_.blocks[i], ownPart(i, &step_));
    segments_[i].cost =
        robustCost(problem_.blocks[i], *problem_.camera, options_.huber, &segments_[i].transfers);
  });
  double sum = problem_.prior.cost(problem_.camera->parameters(), count_);
  for (const SegmentWork& segment : segments_) sum += segment.cost;
  return sum;
}

// After newton_: at most as far as it, and where steps shrink by half or more each time, what is
// left of their geometric series. Held intrinsics say nothing of how far the rest has to go.
double DogLeg::intrinsicsToGo() const {
  if (count_ == 0) return std::numeric_limits<double>::infinity();
  const double ratio = intrinsics_step_ / last_intrinsics_step_;
  return ratio < 0.5 ? intrinsics_step_ * ratio / (1.0 - ratio) : intrinsics_step_;
}

// Takes the step or refuses it; the trust region follows.
void DogLeg::tryStep(SolveSummary* summary) {
  saved_.save(problem_);
  const double cost = apply();
  const double ratio = (cost_ - cost) / predicted_gain_;
  if (std::isfinite(cost) && ratio > 1e-4) {
    const bool full = newton_norm_ <= radius_;
    const bool near = full && intrinsicsToGo() < options_.intrinsics_precision;
    last_intrinsics_step_ = full ? intrinsics_step_ : 0.0;
    summary->converged = near || negligible(cost_ - cost);
    cost_ = summary->final_cost = cost;
    if (ratio > 0.75) radius_ = std::max(radius_, 3.0 * step_norm_);
    if (ratio < 0.25) radius_ = 0.5 * step_norm_;
    damping_ = std::max(kMinDamping, 0.2 * damping_);
    linearized_ = has_path_ = false;
  } else {
    saved_.restore(problem_);
    radius_ = 0.25 * std::min(radius_, step_norm_);
    summary->converged = negligible(predicted_gain_);
  }
}

SolveSummary DogLeg::run() {
  SolveSummary summary;
  linearize();
  summary.initial_cost = summary.final_cost = cost_;
  summary.usable = finite_;
  while (summary.usable && !summary.converged && summary.iterations < options_.max_iterations &&
         radius_ > kMinRadius && (has_path_ || makePath())) {
    ++summary.iterations;
    propose();
    if (!(predicted_gain_ > 0.0) || step_norm_ < options_.precision) {
      summary.converged = true;
    } else {
      tryStep(&summary);
    }
  }
  return summary;
}

}  // namespace

SolveSummary solve(const Problem& problem, const SolverOptions& options) {
  return DogLeg(problem, options).run();
}

}  // namespace camera_self_calibration
