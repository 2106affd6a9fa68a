#include "camera_self_calibration/estimation/problem.h"

#include <algorithm>

namespace camera_self_calibration {

double DepthPrior::cost(const Segment& segment) const {
  if (weight() == 0.0) return 0.0;
  double sum = 0.0;
  for (const Landmark& landmark : segment.landmarks) {
    const double off = landmark.inverse_depth - mean;
    sum += off * off;
  }
  return 0.5 * weight() * sum;
}

Intrinsics IntrinsicsPrior::weights(int count) const {
  Intrinsics result = Intrinsics::Zero(count);
  const int known = std::min(count, static_cast<int>(sigma.size()));
  result.head(known) = sigma.head(known).cwiseAbs2().cwiseInverse();
  return result;
}

Intrinsics IntrinsicsPrior::gradient(const Intrinsics& parameters, int count) const {
  Intrinsics result = Intrinsics::Zero(count);
  const int known = std::min(count, static_cast<int>(mean.size()));
  result.head(known) =
      (mean.head(known) - parameters.head(known)).cwiseProduct(weights(count).head(known));
  return result;
}

double IntrinsicsPrior::cost(const Intrinsics& parameters, int count) const {
  const int known = std::min(count, static_cast<int>(mean.size()));
  return 0.5 *
         (mean.head(known) - parameters.head(known)).dot(gradient(parameters, count).head(known));
}

}  // namespace camera_self_calibration
