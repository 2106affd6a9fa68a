#include "camera_self_calibration/queue/cross_validation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "camera_self_calibration/base/distributions.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/image_field.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/queue/queue_solution.h"

namespace camera_self_calibration {
namespace {

// Probability of calling halves different that are not. The queue changes some ten times in a run
// and most of its segments stay, so that fewer than one run in a hundred sees it.
constexpr double kSignificance = 1e-3;

// What one half of the segments says, to first order about the joint estimate.
struct Half {
  IntrinsicsMatrix information;
  Intrinsics gradient;

  explicit Half(int count)
      : information(IntrinsicsMatrix::Zero(count, count)), gradient(Intrinsics::Zero(count)) {}

  void add(const BlockShare& share) {
    information += share.information;
    gradient += share.gradient;
  }
};

// Mean square error over the image [px^2] of what has this information beside a thousandth of
// `all`, so that directions that it does not tell yet can be compared too.
double meanSquare(const IntrinsicsMatrix& information, const IntrinsicsMatrix& all,
                  const IntrinsicsMatrix& metric) {
  const auto covariance = covarianceFromInformation(information + 1e-3 * all);
  return covariance ? (metric * *covariance).trace() : std::numeric_limits<double>::infinity();
}

// The best segments first, each to the half that is worse off.
std::pair<Half, Half> halves(const QueueSolution& solution, const IntrinsicsMatrix& all,
                             const IntrinsicsMatrix& metric) {
  const int count = static_cast<int>(metric.rows());
  std::vector<std::pair<double, const BlockShare*>> order;
  for (const BlockShare& share : solution.shares) {
    order.emplace_back(meanSquare(share.information, all, metric), &share);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::pair<Half, Half> result{Half(count), Half(count)};
  for (const auto& [error, share] : order) {
    const bool first_is_worse = meanSquare(result.first.information, all, metric) >=
                                meanSquare(result.second.information, all, metric);
    (first_is_worse ? result.first : result.second).add(*share);
  }
  return result;
}

// Probability that `ratio`, a square over its expectation, is so large.
double exceedance(double ratio, double freedom, const Scatter& scatter) {
  const int scatter_freedom = scatter.birgeFreedom();
  return scatter_freedom > 0 ? fExceedance(ratio, freedom, scatter_freedom)
                             : chiSquareExceedance(freedom * ratio, freedom);
}

}  // namespace

bool CrossValidation::agrees() const { return p_value > kSignificance; }

double CrossValidation::blindBelowPx() const {
  return compared ? expected_px : std::numeric_limits<double>::infinity();
}

double CrossValidation::inflation() const {
  return agrees() ? 1.0 : std::max(1.0, difference_px / expected_px);
}

std::string CrossValidation::sentence() const {
  if (!compared) return "";
  return formatted(
      "two parts of the video that share no image %s on the lens (difference %.2f px rms, expected "
      "%.2f px)",
      agrees() ? "agree" : "disagree", difference_px, expected_px);
}

CrossValidation crossValidate(const QueueSolution& solution, const ImageField& field) {
  CrossValidation result;
  if (!solution.usable || solution.shares.size() < 2) return result;
  const IntrinsicsMatrix metric = pixelMetric(solution.camera, field);
  Half all(static_cast<int>(metric.rows()));
  for (const BlockShare& share : solution.shares) all.add(share);
  const auto [one, other] = halves(solution, all.information, metric);
  const auto joint = covarianceFromInformation(all.information);
  const auto covariance = covarianceFromInformation(one.information);
  const auto other_covariance = covarianceFromInformation(other.information);
  if (!joint || !covariance || !other_covariance) return result;
  const Intrinsics difference = *covariance * one.gradient - *other_covariance * other.gradient;
  // What the stated uncertainty allows for beyond the information counts for the halves too.
  const double stated = (metric * solution.covariance).trace() / (metric * *joint).trace();
  const IntrinsicsMatrix squares = stated * (metric * (*covariance + *other_covariance));
  const double expected = squares.trace();
  const double found = difference.dot(metric * difference);
  if (!(expected > 0.0) || !std::isfinite(expected) || !std::isfinite(found)) return result;
  result.compared = true;
  result.difference_px = std::sqrt(found);
  result.expected_px = std::sqrt(expected);
  const double freedom = expected * expected / (squares * squares).trace();
  result.p_value = exceedance(found / expected, freedom, solution.scatter);
  return result;
}

}  // namespace camera_self_calibration
