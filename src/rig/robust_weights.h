#pragma once

#include <algorithm>
#include <vector>

#include "camera_self_calibration/base/median.h"

namespace camera_self_calibration {

constexpr int kReweightingRounds = 10;

// Huber's weights of residuals' norms by their robust scale, which is returned.
inline double reweight(const std::vector<double>& residuals, std::vector<double>* weights) {
  constexpr double kMadToSigma = 1.48;  // of normal errors in one dimension
  constexpr double kHuber = 1.5;        // [sigmas]
  const double sigma = std::max(1e-12, kMadToSigma * median(residuals, 0.0));
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    (*weights)[i] = std::min(1.0, kHuber * sigma / std::max(residuals[i], 1e-300));
  }
  return sigma;
}

}  // namespace camera_self_calibration
