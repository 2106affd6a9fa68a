#pragma once

#include <cmath>

namespace camera_self_calibration {

/// Norm of a whitened reprojection residual beyond which it costs linearly, in all estimates
/// [sigmas]. With right sigmas one residual of two coordinates in seven is larger, exp(-2).
inline constexpr double kHuberThreshold = 2.0;

/// Huber's function of the whitened residual's norm: `norm^2 / 2` up to the threshold, linear
/// beyond it. A threshold <= 0 means none.
inline double huberCost(double norm, double threshold) {
  if (threshold <= 0.0 || norm <= threshold) return 0.5 * norm * norm;
  return threshold * (norm - 0.5 * threshold);
}

/// Weight of the squared residual in iteratively reweighted least squares.
inline double huberWeight(double norm, double threshold) {
  return threshold <= 0.0 || norm <= threshold ? 1.0 : threshold / norm;
}

/// Both for a squared norm: the cost, and the root of the weight. Takes a root only beyond the
/// threshold.
struct HuberLoss {
  double cost;
  double root_weight;

  HuberLoss(double squared_norm, double threshold) : cost(0.5 * squared_norm), root_weight(1.0) {
    if (threshold <= 0.0 || squared_norm <= threshold * threshold) return;
    const double norm = std::sqrt(squared_norm);
    cost = huberCost(norm, threshold);
    root_weight = std::sqrt(huberWeight(norm, threshold));
  }
};

/// What an observation costs that cannot be predicted (its point lies behind the camera, say): as
/// much as a residual of this many pixels, so that no step gains by losing points.
constexpr double kUnpredictableResidualPx = 50.0;

inline double unpredictableCost(double sigma, double threshold) {
  return huberCost(kUnpredictableResidualPx / sigma, threshold);
}

}  // namespace camera_self_calibration
