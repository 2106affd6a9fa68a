#include "camera_self_calibration/lens_change/lens_course.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "camera_self_calibration/base/decompositions.h"
#include "camera_self_calibration/base/distributions.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/queue/scatter.h"

namespace camera_self_calibration {
namespace {

// Standard deviations of what moved, in focal lengths: from what is seldom visible to what no
// window misses, evenly in their logarithms, as nothing is known of the scale.
constexpr double kSizes[] = {1e-3, 3e-3, 1e-2, 3e-2, 1e-1};
// The smallest of them are those of a drift: what moves a focal length further within some 20
// segments is not slow.
constexpr int kDriftSizes = 3;
constexpr double kLeastAge = 1e-6;    // [minutes]: ages are divided by
constexpr double kNegligible = 1e-6;  // weight of a hypothesis in an average

enum class Kind { kStep, kDrift, kOutlier };

// How often lenses move, for the average: segments that tell little rule nothing out, so what they
// cannot exclude must be as rare there as it is in use, or the lens would be in doubt for ever.
constexpr double kStepsPerMinute = 1.0 / 60.0;  // bumped, refocused or zoomed: once an hour
constexpr double kFastestDrift = 1e-2;          // [1/minute]; one that warms up is far slower
constexpr double kOddsOfDrift = 0.1;            // of a camera that warms up while it films
constexpr double kOddsOfOutlier = 0.1;          // of video that holds a segment that is wrong

// The deviations of all segments as linear functions of independent unknowns, each of variance
// size^2, that the segments' likelihoods do not couple once x is eliminated.
struct Course {
  Kind kind = Kind::kStep;
  std::size_t first = 0;             // the first segment after a step
  double share = 1.0;                // of its kind's prior
  double odds = 0.0;                 // against a lens that stayed, before anything is seen
  double per_minute = 0.0;           // sigma of the relative change over one minute, in sizes
  Eigen::VectorXd information = {};  // of the unknowns
  Eigen::VectorXd gradient = {};
  Eigen::MatrixXd leverage = {};  // of the unknowns on x
};

// A course of one size.
struct Hypothesis {
  const Course* course;
  double size;
  Eigen::VectorXd variance;  // of the unknowns, after all segments
  double left = 0.0;         // of chi-square
  double log_factor = 0.0;  // Bayes factor against a lens that stayed, times its share of the prior
  double log_odds = -LensCourse::kNever;  // against it, after all segments

  double perMinute() const { return size * course->per_minute; }
};

// The mean and covariance of a mixture of Gaussians.
struct Mixture {
  Intrinsics mean;
  IntrinsicsMatrix square;

  explicit Mixture(Eigen::Index count)
      : mean(Intrinsics::Zero(count)), square(IntrinsicsMatrix::Zero(count, count)) {}
  void add(double weight, const Intrinsics& value, const IntrinsicsMatrix& covariance) {
    mean += weight * value;
    square += weight * (covariance + value * value.transpose());
  }
  IntrinsicsMatrix covariance() const { return square - mean * mean.transpose(); }
};

double minutesAgo(const QuadraticLikelihood& segment, std::int64_t now_ns) {
  const double twice =
      static_cast<double>(now_ns - segment.begin_ns) + static_cast<double>(now_ns - segment.end_ns);
  return std::max(kLeastAge, 0.5e-9 / 60.0 * twice);
}

double logSum(double a, double b) {
  const double most = std::max(a, b);
  return most + std::log(std::exp(a - most) + std::exp(b - most));
}

// Of this logarithm, over the hypotheses that are wanted.
template <typename Keep>
double logSum(const std::vector<Hypothesis>& hypotheses, double Hypothesis::*logarithm,
              const Keep& keep) {
  double sum = -LensCourse::kNever;
  for (const Hypothesis& one : hypotheses) {
    if (keep(*one.course)) sum = logSum(sum, one.*logarithm);
  }
  return sum;
}

class Account {
 public:
  Account(const std::vector<QuadraticLikelihood>& segments, const Camera& camera,
          std::int64_t now_ns);
  bool usable() const { return covariance_.has_value(); }
  LensCourse conclude() const;

 private:
  void addCourses();
  void add(Course course, const std::vector<double>& weights, const Eigen::MatrixXd& basis);
  void addWalk();
  void add(Course course, const Eigen::MatrixXd& cross, const Eigen::MatrixXd& information,
           const Eigen::VectorXd& gradient);
  std::vector<Hypothesis> hypotheses() const;
  Scatter scatterOf(double left) const {
    return Scatter{std::max(0.0, left), freedom_}.moderated();
  }
  double logLikelihood(double left) const;
  double variance(double left) const;
  void average(const std::vector<Hypothesis>& hypotheses, LensCourse* result) const;

  const std::vector<QuadraticLikelihood>& segments_;  // in the order of time
  Intrinsics point_;
  std::vector<double> ages_;  // [minutes]
  std::vector<Intrinsics> gradients_;
  Intrinsics gradient_;
  std::optional<IntrinsicsMatrix> covariance_;  // of a lens that stayed
  double square_ = 0.0;                         // chi-square of it
  int freedom_ = 0;
  std::vector<Course> courses_;
};

Account::Account(const std::vector<QuadraticLikelihood>& segments, const Camera& camera,
                 std::int64_t now_ns)
    : segments_(segments), point_(camera.parameters().head(camera.estimatedCount())) {
  const auto count = point_.size();
  gradient_ = Intrinsics::Zero(count);
  IntrinsicsMatrix information = IntrinsicsMatrix::Zero(count, count);
  for (const QuadraticLikelihood& segment : segments) {
    ages_.push_back(minutesAgo(segment, now_ns));
    gradients_.push_back(segment.gradientAt(point_));
    gradient_ += gradients_.back();
    information += segment.information;
    square_ += squaredDistance(gradients_.back(), segment.information);
  }
  freedom_ = static_cast<int>((static_cast<Eigen::Index>(segments.size()) - 1) * count);
  covariance_ = covarianceFromInformation(information);
  if (!covariance_ || segments.size() < 2) return;
  square_ = std::max(0.0, square_ - gradient_.dot(*covariance_ * gradient_));
  addCourses();
}

void Account::addCourses() {
  const std::size_t n = segments_.size();
  // Focal lengths and centre in focal lengths, distortion in its own units.
  Eigen::VectorXd units = Eigen::VectorXd::Ones(point_.size());
  units.head<4>() << point_(0), point_(1), point_(0), point_(1);
  const Eigen::MatrixXd all = units.asDiagonal();
  const Eigen::MatrixXd focal = all.leftCols(2).rowwise().sum();
  const double steps = static_cast<double>(n - 1);
  for (std::size_t k = 0; k < n; ++k) {
    std::vector<double> alone(n, 0.0), before(n, 0.0), ramp(n, 0.0);
    alone[k] = 1.0;
    for (std::size_t i = 0; i < n; ++i) {
      before[i] = i < k ? 1.0 : 0.0;
      ramp[i] = k > 0 ? std::min(1.0, ages_[i] / ages_[k - 1]) : 0.0;
    }
    for (const Eigen::MatrixXd& basis : {focal, all}) {
      const double one = 0.5 / static_cast<double>(n);
      add({Kind::kOutlier, k, one, one * kOddsOfOutlier}, alone, basis);
      if (k == 0) continue;
      const double odds = 0.5 * kStepsPerMinute * (ages_[k - 1] - ages_[k]);
      add({Kind::kStep, k, 0.5 / steps, odds}, before, basis);
    }
    if (k == 0 || k + 1 == n) continue;  // of a single segment it would be a step
    const double share = 0.5 / (steps - 1.0);
    add({Kind::kDrift, k, share, share * kOddsOfDrift, 1.0 / ages_[k - 1]}, ramp, focal);
  }
  addWalk();
}

void Account::add(Course course, const std::vector<double>& weights, const Eigen::MatrixXd& basis) {
  const auto count = point_.size();
  IntrinsicsMatrix once = IntrinsicsMatrix::Zero(count, count);
  IntrinsicsMatrix twice = once;
  Intrinsics gradient = Intrinsics::Zero(count);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0.0) continue;
    once += weights[i] * segments_[i].information;
    twice += weights[i] * weights[i] * segments_[i].information;
    gradient += weights[i] * gradients_[i];
  }
  add(std::move(course), once * basis, basis.transpose() * twice * basis,
      basis.transpose() * gradient);
}

// Independent steps of the focal length back to each segment, of variance 1 over all of the time.
void Account::addWalk() {
  const auto n = static_cast<Eigen::Index>(segments_.size());
  Intrinsics direction = Intrinsics::Zero(point_.size());
  direction.head<2>() = point_.head<2>();
  Eigen::MatrixXd cross(point_.size(), n);
  Eigen::VectorXd information(n), gradient(n);
  Eigen::MatrixXd steps = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    cross.col(i) = segments_[at].information * direction;
    information(i) = direction.dot(cross.col(i));
    gradient(i) = direction.dot(gradients_[at]);
    const double length = ages_[at] - (i + 1 < n ? ages_[at + 1] : 0.0);
    steps.block(0, i, i + 1, 1).setConstant(std::sqrt(std::max(0.0, length) / ages_[0]));
  }
  add({Kind::kDrift, 0, 0.5, 0.5 * kOddsOfDrift, 1.0 / std::sqrt(ages_[0])}, cross * steps,
      steps.transpose() * information.asDiagonal() * steps, steps.transpose() * gradient);
}

void Account::add(Course course, const Eigen::MatrixXd& cross, const Eigen::MatrixXd& information,
                  const Eigen::VectorXd& gradient) {
  const Eigen::MatrixXd leverage = *covariance_ * cross;
  const SymmetricEigen eigen = symmetricEigen(information - cross.transpose() * leverage);
  if (!eigen.values.allFinite()) return;
  course.information = eigen.values.cwiseMax(0.0);
  course.gradient = eigen.vectors.transpose() * (gradient - leverage.transpose() * gradient_);
  course.leverage = leverage * eigen.vectors;
  courses_.push_back(std::move(course));
}

// Of what is left of chi-square, v integrated: with a = (5 + freedom) / 2 and b = (5 + left) / 2
// the integral of u^(a-1) e^(-b u) over u = 1/v from 0 to 1.
double Account::logLikelihood(double left) const {
  const Scatter scatter = scatterOf(left);
  return logIncompleteGamma(0.5 * scatter.freedom, 0.5 * scatter.chi_square);
}

// v as the segments show it.
double Account::variance(double left) const {
  const double ratio = scatterOf(left).birgeRatio();
  return ratio * ratio;
}

std::vector<Hypothesis> Account::hypotheses() const {
  std::vector<Hypothesis> result;
  const double stayed = logLikelihood(square_);
  for (const Course& course : courses_) {
    const int sizes =
        course.kind == Kind::kDrift ? kDriftSizes : static_cast<int>(std::size(kSizes));
    for (int i = 0; i < sizes; ++i) {
      const double size = kSizes[i];
      const double variance = size * size;
      Hypothesis one{&course, size, {}};
      one.variance = variance * (1.0 + variance * course.information.array()).inverse();
      one.left = square_ - course.gradient.cwiseAbs2().dot(one.variance);
      // What leaves the segments disagreeing explains nothing.
      if (one.left > kMaxBirgeRatio * kMaxBirgeRatio * freedom_) continue;
      const double log_likelihood =
          logLikelihood(one.left) - stayed + 0.5 * (one.variance.array() / variance).log().sum();
      one.log_factor = std::log(course.share / sizes) + log_likelihood;
      if (one.perMinute() <= kFastestDrift && course.odds > 0.0)
        one.log_odds = std::log(course.odds / sizes) + log_likelihood;
      result.push_back(std::move(one));
    }
  }
  return result;
}

LensCourse Account::conclude() const {
  LensCourse result;
  const std::vector<Hypothesis> all = hypotheses();
  const auto of = [](Kind kind) { return [kind](const Course& one) { return one.kind == kind; }; };
  result.step = logSum(all, &Hypothesis::log_factor, of(Kind::kStep));
  result.drift = logSum(all, &Hypothesis::log_factor, of(Kind::kDrift));
  result.outlier = logSum(all, &Hypothesis::log_factor, of(Kind::kOutlier));
  double most = -LensCourse::kNever;
  for (std::size_t k = 1; k < segments_.size(); ++k) {
    const double here = logSum(all, &Hypothesis::log_factor, [k](const Course& one) {
      return one.kind == Kind::kStep && one.first == k;
    });
    if (!(here > most)) continue;
    most = here;
    result.onset_ns = segments_[k].begin_ns;
  }
  for (std::size_t k = 0; k + 1 < segments_.size(); ++k) {
    const auto is_it = [k](const Course& one) {
      return one.kind == Kind::kOutlier && one.first == k;
    };
    const auto is_other = [&](const Course& one) { return !is_it(one); };
    const double odds = logSum(all, &Hypothesis::log_odds, is_it) -
                        logSum(0.0, logSum(all, &Hypothesis::log_odds, is_other));
    if (!(odds > result.wrong)) continue;
    result.wrong = odds;
    result.wrong_begin_ns = segments_[k].begin_ns;
  }
  for (const Hypothesis& one : all) {
    if (one.course->kind != Kind::kDrift) continue;
    result.rate += std::exp(one.log_factor - result.drift) * one.perMinute();
  }
  average(all, &result);
  return result;
}

// Over all hypotheses, and a lens that stayed.
void Account::average(const std::vector<Hypothesis>& hypotheses, LensCourse* result) const {
  double most = 0.0;
  for (const Hypothesis& one : hypotheses) most = std::max(most, one.log_odds);
  double sum = std::exp(-most);
  for (const Hypothesis& one : hypotheses) sum += std::exp(one.log_odds - most);
  const double log_total = most + std::log(sum);
  const Intrinsics stayed = *covariance_ * gradient_;
  Mixture mixture(point_.size());
  mixture.add(std::exp(-log_total), stayed, variance(square_) * *covariance_);
  for (const Hypothesis& one : hypotheses) {
    const double weight = std::exp(one.log_odds - log_total);
    if (weight < kNegligible) continue;
    const Eigen::MatrixXd& leverage = one.course->leverage;
    const Intrinsics off = leverage * one.variance.cwiseProduct(one.course->gradient).eval();
    const IntrinsicsMatrix more = leverage * one.variance.asDiagonal() * leverage.transpose();
    mixture.add(weight, stayed - off, variance(one.left) * (*covariance_ + more));
  }
  result->now = point_ + mixture.mean;
  result->covariance = mixture.covariance();
}

// Those of the camera's model, in the order of time.
std::vector<QuadraticLikelihood> inOrder(std::vector<QuadraticLikelihood> segments,
                                         const Camera& camera) {
  const auto of_other_model = [&](const QuadraticLikelihood& segment) {
    return segment.point.size() != camera.estimatedCount();
  };
  segments.erase(std::remove_if(segments.begin(), segments.end(), of_other_model), segments.end());
  std::sort(segments.begin(), segments.end(),
            [](const QuadraticLikelihood& a, const QuadraticLikelihood& b) {
              return a.begin_ns + a.end_ns < b.begin_ns + b.end_ns;
            });
  return segments;
}

}  // namespace

double LensCourse::moved() const { return logSum(step, drift) + std::log(0.5); }

double LensCourse::pValue() const { return std::exp(-std::max(0.0, moved())); }

bool LensCourse::exceeds(double factor) const {
  return moved() > std::log(factor) + std::max(0.0, outlier);
}

LensCourse courseOfLens(std::vector<QuadraticLikelihood> segments, const Camera& camera,
                        std::int64_t now_ns) {
  segments = inOrder(std::move(segments), camera);
  if (segments.size() < 2) return {};
  const Account account(segments, camera, now_ns);
  return account.usable() ? account.conclude() : LensCourse();
}

}  // namespace camera_self_calibration
