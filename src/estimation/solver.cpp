#include "camera_self_calibration/estimation/solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "camera_self_calibration/estimation/linear_segment.h"
#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/estimation/parallel.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

constexpr double kInitialRadius = 1e4;
constexpr double kMinRadius = 1e-12;
constexpr double kMinDamping = 1e-10;
constexpr double kMaxDamping = 1.0;

// A change of all variables; also used for the column scale and for scaled vectors.
struct Step {
  Intrinsics intrinsics;
  std::vector<SegmentStep> segments;

  template <typename Function>
  void forEach(const Function& function) {
    function(intrinsics, 0);
    for (std::size_t s = 0; s < segments.size(); ++s) {
      function(segments[s].poses, s);
      function(segments[s].landmarks, s);
    }
  }
};

double dot(const Step& a, const Step& b) {
  double sum = a.intrinsics.dot(b.intrinsics);
  for (std::size_t s = 0; s < a.segments.size(); ++s) {
    sum += a.segments[s].poses.dot(b.segments[s].poses);
    sum += a.segments[s].landmarks.dot(b.segments[s].landmarks);
  }
  return sum;
}

// Combines two steps entry by entry.
template <typename Function>
Step combine(const Step& a, const Step& b, const Function& function) {
  Step result = a;
  result.intrinsics = a.intrinsics.binaryExpr(b.intrinsics, function);
  for (std::size_t s = 0; s < a.segments.size(); ++s) {
    result.segments[s].poses = a.segments[s].poses.binaryExpr(b.segments[s].poses, function);
    result.segments[s].landmarks =
        a.segments[s].landmarks.binaryExpr(b.segments[s].landmarks, function);
  }
  return result;
}

// What a step changes.
struct State {
  Camera camera;
  std::vector<Segment> segments;
};

class DogLeg {
 public:
  DogLeg(const Problem& problem, const SolverOptions& options)
      : problem_(problem), options_(options), count_(problem.intrinsicsCount()) {
    linear_.resize(problem.blocks.size());
    costs_.resize(problem.blocks.size());
  }

  SolveSummary run();

 private:
  void linearize();
  bool gaussNewton();
  void cauchy();
  bool preparePath();
  void tryStep(const Step& step, double norm, double predicted, SolveSummary* summary);
  Step trialStep(double radius) const;
  double curvature(const Step& step) const;
  double apply(const Step& step);
  void save();
  void restore();
  double evaluate();

  Problem problem_;
  SolverOptions options_;
  int count_;
  double damping_ = kMinDamping;
  double radius_ = kInitialRadius;
  bool fresh_ = true;  // linearised since the last path

  std::vector<LinearSegment> linear_;
  std::vector<double> costs_;
  State saved_;

  double cost_ = 0.0;
  Step gradient_;
  Step scale_;  // column norms of J
  Step gauss_newton_;
  Step cauchy_;
};

void DogLeg::linearize() {
  const int blocks = static_cast<int>(problem_.blocks.size());
  parallelFor(options_.threads, blocks, [this](int i) {
    linear_[i].linearize(problem_.blocks[i], *problem_.camera, count_, options_.huber);
  });
  gradient_.intrinsics.setZero(count_);
  scale_.intrinsics.setZero(count_);
  gradient_.segments.resize(blocks);
  scale_.segments.resize(blocks);
  cost_ = 0.0;
  for (int i = 0; i < blocks; ++i) {
    const LinearSegment& linear = linear_[i];
    cost_ += linear.cost();
    gradient_.intrinsics += linear.gradient().tail(count_);
    gradient_.segments[i] = {linear.gradient().head(linear.poseColumns()),
                             linear.landmarkGradient()};
    const Eigen::VectorXd diagonal = linear.diagonal();
    scale_.intrinsics += diagonal.tail(count_);
    scale_.segments[i] = {diagonal.head(linear.poseColumns()), linear.landmarkDiagonal()};
  }
  const Intrinsics& parameters = problem_.camera->parameters();
  cost_ += problem_.prior.cost(parameters, count_);
  gradient_.intrinsics += problem_.prior.gradient(parameters, count_);
  scale_.intrinsics += problem_.prior.weights(count_);
  // A column without information has no gradient either: any positive scale serves.
  scale_.forEach([](auto& squares, std::size_t) {
    squares = squares.unaryExpr([](double s) { return s > 0.0 ? std::sqrt(s) : 1.0; }).eval();
  });
}

bool DogLeg::gaussNewton() {
  const int blocks = static_cast<int>(problem_.blocks.size());
  parallelFor(options_.threads, blocks, [this](int i) { linear_[i].eliminate(damping_); });
  gauss_newton_.intrinsics.setZero(count_);
  if (count_ > 0) {
    Eigen::MatrixXd reduced = problem_.prior.weights(count_).asDiagonal();
    Eigen::VectorXd right = problem_.prior.gradient(problem_.camera->parameters(), count_);
    for (const LinearSegment& linear : linear_) {
      reduced += linear.reducedHessian();
      right += linear.reducedGradient();
    }
    if (!reduced.allFinite()) return false;
    const Eigen::MatrixXd factor = inverseFactor(reduced, LinearSegment::kRankTolerance);
    gauss_newton_.intrinsics = factor * (factor.transpose() * right);
  }
  gauss_newton_.segments.resize(blocks);
  parallelFor(options_.threads, blocks, [this](int i) {
    gauss_newton_.segments[i] = linear_[i].backSubstitute(gauss_newton_.intrinsics);
  });
  return std::isfinite(dot(gauss_newton_, gauss_newton_));
}

double DogLeg::curvature(const Step& step) const {
  double sum = step.intrinsics.cwiseAbs2().dot(problem_.prior.weights(count_));
  for (std::size_t i = 0; i < linear_.size(); ++i) {
    sum += linear_[i].curvature(step.segments[i], step.intrinsics);
  }
  return sum;
}

// The point of the dog-leg path on the trust region's border, in original variables; the region is
// a ball in the scaled ones.
Step DogLeg::trialStep(double radius) const {
  const auto multiply = [](double a, double b) { return a * b; };
  const Step newton = combine(gauss_newton_, scale_, multiply);
  const double newton_norm = std::sqrt(dot(newton, newton));
  if (newton_norm <= radius) return gauss_newton_;
  const Step cauchy = combine(cauchy_, scale_, multiply);
  const double cauchy_norm = std::sqrt(dot(cauchy, cauchy));
  if (cauchy_norm >= radius) {
    const double shrink = radius / cauchy_norm;
    return combine(cauchy_, cauchy_, [shrink](double a, double) { return shrink * a; });
  }
  const Step leg = combine(newton, cauchy, [](double a, double b) { return a - b; });
  const double a = dot(leg, leg);
  const double b = dot(cauchy, leg);
  const double c = radius * radius - cauchy_norm * cauchy_norm;
  const double t = c / (b + std::sqrt(std::max(0.0, b * b + a * c)));
  return combine(cauchy_, gauss_newton_, [t](double x, double y) { return x + t * (y - x); });
}

void DogLeg::save() {
  saved_.camera = *problem_.camera;
  saved_.segments.resize(problem_.blocks.size());
  for (std::size_t i = 0; i < problem_.blocks.size(); ++i) {
    saved_.segments[i].keyframes = problem_.blocks[i].segment->keyframes;
    saved_.segments[i].landmarks = problem_.blocks[i].segment->landmarks;
  }
}

void DogLeg::restore() {
  *problem_.camera = saved_.camera;
  for (std::size_t i = 0; i < problem_.blocks.size(); ++i) {
    problem_.blocks[i].segment->keyframes = saved_.segments[i].keyframes;
    problem_.blocks[i].segment->landmarks = saved_.segments[i].landmarks;
  }
}

void applyToSegment(const SegmentBlock& block, const SegmentStep& step) {
  Segment& segment = *block.segment;
  for (int k = block.fixed_keyframes, column = 0; k < static_cast<int>(segment.keyframes.size());
       ++k, column += 6) {
    Rigid3& pose = segment.keyframes[k].world_from_camera;
    pose.translation += step.poses.segment<3>(column);
    pose.rotation = (pose.rotation * expSo3(step.poses.segment<3>(column + 3))).normalized();
  }
  int row = 0;
  for (int l = 0; l < static_cast<int>(segment.landmarks.size()); ++l) {
    Landmark& landmark = segment.landmarks[l];
    if (l != block.fixed_landmark) landmark.inverse_depth += step.landmarks(row++);
    if (landmark.anchored) continue;
    landmark.bearing =
        (landmark.bearing + tangentBasis(landmark.bearing) * step.landmarks.segment<2>(row))
            .normalized();
    row += 2;
  }
}

double DogLeg::evaluate() {
  parallelFor(options_.threads, static_cast<int>(costs_.size()), [this](int i) {
    costs_[i] = robustCost(problem_.blocks[i], *problem_.camera, options_.huber);
  });
  double sum = problem_.prior.cost(problem_.camera->parameters(), count_);
  for (const double cost : costs_) sum += cost;
  return sum;
}

double DogLeg::apply(const Step& step) {
  if (count_ > 0) {
    Intrinsics parameters = problem_.camera->parameters();
    parameters.head(count_) += step.intrinsics;
    problem_.camera->setParameters(parameters);
    if (!problem_.camera->valid()) return std::numeric_limits<double>::infinity();
  }
  for (std::size_t i = 0; i < problem_.blocks.size(); ++i) {
    applyToSegment(problem_.blocks[i], step.segments[i]);
  }
  return evaluate();
}

// Steepest descent in the scaled variables, to the minimum of the quadratic model: D^-2 b.
void DogLeg::cauchy() {
  cauchy_ = combine(gradient_, scale_, [](double b, double d) { return b / (d * d); });
  const double steepness = dot(cauchy_, gradient_);
  const double bend = curvature(cauchy_);
  const double length = bend > 0.0 ? steepness / bend : 0.0;
  cauchy_ = combine(cauchy_, cauchy_, [length](double a, double) { return length * a; });
}

// Both ends of the dog-leg path at a new linearisation; false where no step can be computed.
bool DogLeg::preparePath() {
  if (!fresh_) return true;
  while (!gaussNewton() && damping_ < kMaxDamping) damping_ *= 10.0;
  if (damping_ >= kMaxDamping) return false;
  cauchy();
  fresh_ = false;
  return true;
}

// Takes a step of this scaled norm and predicted gain, or refuses it; the trust region follows.
void DogLeg::tryStep(const Step& step, double norm, double predicted, SolveSummary* summary) {
  save();
  const double cost = apply(step);
  const double ratio = (cost_ - cost) / predicted;
  if (std::isfinite(cost) && ratio > 1e-4) {
    summary->converged = cost_ - cost < options_.cost_tolerance * cost_;
    summary->final_cost = cost;
    if (ratio > 0.75) radius_ = std::max(radius_, 3.0 * norm);
    if (ratio < 0.25) radius_ = 0.5 * norm;
    linearize();
    fresh_ = true;
    damping_ = std::max(kMinDamping, 0.2 * damping_);
  } else {
    restore();
    radius_ = 0.25 * std::min(radius_, norm);
    summary->converged = predicted < options_.cost_tolerance * cost_;
  }
}

SolveSummary DogLeg::run() {
  SolveSummary summary;
  linearize();
  summary.initial_cost = summary.final_cost = cost_;
  summary.usable = std::isfinite(cost_);
  while (summary.usable && !summary.converged && summary.iterations < options_.max_iterations &&
         radius_ > kMinRadius && preparePath()) {
    ++summary.iterations;
    const Step step = trialStep(radius_);
    const Step scaled = combine(step, scale_, [](double a, double d) { return a * d; });
    const double norm = std::sqrt(dot(scaled, scaled));
    const double predicted = dot(gradient_, step) - 0.5 * curvature(step);
    if (!(predicted > 0.0) || norm < options_.step_tolerance) {
      summary.converged = true;
    } else {
      tryStep(step, norm, predicted, &summary);
    }
  }
  return summary;
}

}  // namespace

SolveSummary solve(const Problem& problem, const SolverOptions& options) {
  return DogLeg(problem, options).run();
}

}  // namespace camera_self_calibration
