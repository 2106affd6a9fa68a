#include "camera_self_calibration/lens_change/lens_drift.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "camera_self_calibration/estimation/pseudo_inverse.h"
#include "camera_self_calibration/queue/scatter.h"

namespace camera_self_calibration {
namespace {

constexpr std::size_t kMinSegments = 4;
// Standard deviations of the relative change over one minute: more is no drift.
constexpr double kRates[] = {3e-4, 6e-4, 1.2e-3, 2.5e-3, 5e-3, 1e-2};
// Twice the logarithm of the likelihood ratio: by chance in one of fifty queues.
constexpr double kSignificant = 4.0;
constexpr double kSignificantWithout = 2.0;  // any one of the segments

double minutesAgo(const QuadraticLikelihood& segment, std::int64_t now_ns) {
  const double middle = 0.5 * (static_cast<double>(segment.begin_ns - now_ns) +
                               static_cast<double>(segment.end_ns - now_ns));
  return std::max(0.0, -middle / 60e9);
}

// What a segment says, from the queue's estimate.
struct Saying {
  double minutes = 0.0;  // ago
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
  double square = 0.0;  // d^T I d, d its own estimate
};

// Newest first.
std::vector<Saying> sayingsOf(const std::vector<QuadraticLikelihood>& segments,
                              const Intrinsics& point, std::int64_t now_ns) {
  std::vector<Saying> sayings;
  for (const QuadraticLikelihood& segment : segments) {
    if (segment.point.size() != point.size()) continue;
    Saying saying{minutesAgo(segment, now_ns), segment.gradientAt(point), segment.information};
    saying.square = squaredDistance(saying.gradient, saying.information);
    sayings.push_back(std::move(saying));
  }
  std::sort(sayings.begin(), sayings.end(),
            [](const Saying& a, const Saying& b) { return a.minutes < b.minutes; });
  return sayings;
}

struct Fit {
  double misfit = std::numeric_limits<double>::infinity();    // -2 log likelihood
  double variance = std::numeric_limits<double>::infinity();  // by which the segments' is larger
  Eigen::VectorXd now;                                        // from the point
  Eigen::MatrixXd covariance;
};

// Unknowns: the intrinsics now, then the walk's independent steps back to each segment, each of
// variance 1; `direction` is the change of the intrinsics per relative change of the focal length.
Fit fitWalk(const std::vector<Saying>& sayings, const Intrinsics& direction, double rate) {
  const auto c = direction.size();
  const auto n = static_cast<Eigen::Index>(sayings.size());
  const auto freedom = static_cast<double>((n - 1) * c);
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(c + n, c + n);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(c + n);
  hessian.diagonal().tail(n).setOnes();
  Eigen::VectorXd steps = Eigen::VectorXd::Zero(n);  // lengths; those to the segment
  double square = 0.0;
  double minutes = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Saying& saying = sayings[static_cast<std::size_t>(i)];
    steps(i) = rate * std::sqrt(saying.minutes - minutes);
    minutes = saying.minutes;
    const Eigen::VectorXd along = saying.information * direction;
    hessian.topLeftCorner(c, c) += saying.information;
    hessian.bottomLeftCorner(n, c) += steps * along.transpose();
    hessian.bottomRightCorner(n, n) += direction.dot(along) * steps * steps.transpose();
    gradient.head(c) += saying.gradient;
    gradient.tail(n) += direction.dot(saying.gradient) * steps;
    square += saying.square;
  }
  hessian.topRightCorner(c, n) = hessian.bottomLeftCorner(n, c).transpose();
  const Eigen::VectorXd scale = hessian.diagonal().unaryExpr(&inverseRoot);
  const Eigen::LLT<Eigen::MatrixXd> factor(scale.asDiagonal() * hessian * scale.asDiagonal());
  Fit fit;
  if (factor.info() != Eigen::Success) return fit;
  const Eigen::MatrixXd lower = factor.matrixL();
  const double log_determinant =
      2.0 * (lower.diagonal().array().log().sum() - scale.array().log().sum());
  const Eigen::MatrixXd inverse =
      scale.asDiagonal() * factor.solve(Eigen::MatrixXd(scale.asDiagonal()));
  const Eigen::VectorXd best = inverse * gradient;
  const double left = std::max(0.0, square - gradient.dot(best));
  // The factor of all variances that is likeliest, as segments may disagree in everything.
  fit.variance = std::max(1.0, left / freedom);
  fit.misfit = freedom * std::log(fit.variance) + log_determinant + left / fit.variance;
  fit.now = best.head(c);
  fit.covariance = fit.variance * inverse.topLeftCorner(c, c);
  return fit;
}

// A walk that leaves the segments disagreeing explains nothing.
bool explains(const Fit& walk) { return walk.variance <= kMaxInflation * kMaxInflation; }

// By how much a walk of this rate is the better explanation; not at all if it is none.
double evidenceFor(const std::vector<Saying>& sayings, const Intrinsics& direction, double rate) {
  const Fit walk = fitWalk(sayings, direction, rate);
  return explains(walk) ? fitWalk(sayings, direction, 0.0).misfit - walk.misfit : 0.0;
}

// No single segment may decide: one that shows something that moves is not the lens's.
bool holdsWithoutAny(const std::vector<Saying>& sayings, const Intrinsics& direction, double rate) {
  for (std::size_t i = 0; i < sayings.size(); ++i) {
    std::vector<Saying> others = sayings;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    if (!(evidenceFor(others, direction, rate) > kSignificantWithout)) return false;
  }
  return true;
}

}  // namespace

Intrinsics alongFocalLength(const Intrinsics& point) {
  Intrinsics direction = Intrinsics::Zero(point.size());
  direction.head<2>() = point.head<2>();
  return direction;
}

LensDrift estimateDrift(const std::vector<QuadraticLikelihood>& queue,
                        const std::vector<QuadraticLikelihood>& others, const Camera& camera,
                        std::int64_t now_ns) {
  LensDrift drift;
  if (queue.size() + others.size() < kMinSegments || queue.size() < 2) return drift;
  const Intrinsics point = camera.parameters().head(camera.estimatedCount());
  const Intrinsics direction = alongFocalLength(point);
  const std::vector<Saying> joint = sayingsOf(queue, point, now_ns);
  std::vector<QuadraticLikelihood> all = queue;
  all.insert(all.end(), others.begin(), others.end());
  const std::vector<Saying> sayings = sayingsOf(all, point, now_ns);
  if (joint.empty() || sayings.size() < kMinSegments) return drift;
  const Fit still = fitWalk(sayings, direction, 0.0);
  Fit best = still;
  for (const double rate : kRates) {
    const Fit fit = fitWalk(sayings, direction, rate);
    if (!(fit.misfit < best.misfit)) continue;
    best = fit;
    drift.rate = rate;
  }
  if (!explains(best) || !(still.misfit - best.misfit > kSignificant) ||
      !holdsWithoutAny(sayings, direction, drift.rate)) {
    return LensDrift();
  }
  const Fit constant = fitWalk(joint, direction, 0.0);
  if (constant.now.size() != best.now.size()) return LensDrift();
  drift.offset = best.now - constant.now;
  drift.covariance = best.covariance;
  Intrinsics parameters = camera.parameters();
  parameters.head(drift.offset.size()) += drift.offset;
  Camera now = camera;
  now.setParameters(parameters);
  drift.significant = now.valid();
  return drift;
}

double driftEvidence(const std::vector<QuadraticLikelihood>& segments, const Camera& camera,
                     std::int64_t now_ns) {
  const Intrinsics point = camera.parameters().head(camera.estimatedCount());
  const Intrinsics direction = alongFocalLength(point);
  const std::vector<Saying> sayings = sayingsOf(segments, point, now_ns);
  double most = 0.0;
  for (const double rate : kRates) most = std::max(most, evidenceFor(sayings, direction, rate));
  return most;
}

}  // namespace camera_self_calibration
