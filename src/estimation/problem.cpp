#include "camera_self_calibration/estimation/problem.h"

#include <algorithm>
#include <cmath>

namespace camera_self_calibration {
namespace {

// Of the first `count` parameters, how many have a prior.
int knownCount(const IntrinsicsPrior& prior, int count) {
  return std::min(
      {count, static_cast<int>(prior.mean.size()), static_cast<int>(prior.sigma.size())});
}

bool knowsAspect(const IntrinsicsPrior& prior, int count) {
  return prior.aspect_sigma > 0.0 && count >= 2;
}

double aspectInSigmas(const Intrinsics& parameters, double sigma) {
  return std::log(parameters(0) / parameters(1)) / sigma;
}

// Its derivatives by fx and fy.
Eigen::Vector2d aspectRow(const Intrinsics& parameters, double sigma) {
  return Eigen::Vector2d(1.0 / parameters(0), -1.0 / parameters(1)) / sigma;
}

}  // namespace

double InverseDepthPrior::cost(const Segment& segment) const {
  if (weight() == 0.0) return 0.0;
  double sum = 0.0;
  for (const Landmark& landmark : segment.landmarks) {
    const double off = landmark.inverse_depth - mean;
    sum += off * off;
  }
  return 0.5 * weight() * sum;
}

double IntrinsicsPrior::cost(const Intrinsics& parameters, int count) const {
  const int known = knownCount(*this, count);
  const double sum =
      (mean.head(known) - parameters.head(known)).cwiseQuotient(sigma.head(known)).squaredNorm();
  if (!knowsAspect(*this, count)) return 0.5 * sum;
  const double aspect = aspectInSigmas(parameters, aspect_sigma);
  return 0.5 * (sum + aspect * aspect);
}

Intrinsics IntrinsicsPrior::gradient(const Intrinsics& parameters, int count) const {
  Intrinsics result = Intrinsics::Zero(count);
  const int known = knownCount(*this, count);
  result.head(known) =
      (mean.head(known) - parameters.head(known)).cwiseQuotient(sigma.head(known).cwiseAbs2());
  if (knowsAspect(*this, count)) {
    const double aspect = aspectInSigmas(parameters, aspect_sigma);
    result.head<2>() -= aspect * aspectRow(parameters, aspect_sigma);
  }
  return result;
}

IntrinsicsMatrix IntrinsicsPrior::information(const Intrinsics& parameters, int count) const {
  IntrinsicsMatrix result = IntrinsicsMatrix::Zero(count, count);
  const int known = knownCount(*this, count);
  result.diagonal().head(known) = sigma.head(known).cwiseAbs2().cwiseInverse();
  if (knowsAspect(*this, count)) {
    const Eigen::Vector2d row = aspectRow(parameters, aspect_sigma);
    result.topLeftCorner<2, 2>() += row * row.transpose();
  }
  return result;
}

}  // namespace camera_self_calibration
