#pragma once

#include <limits>

namespace camera_self_calibration {

/// How long a vector is that is only seen with noise, which makes it look longer: its square less
/// that of the noise is on average the square of the true length.
struct NoisyLength {
  double found = std::numeric_limits<double>::infinity();  ///< As it is seen.
  double noise = std::numeric_limits<double>::infinity();  ///< What noise alone looks like, rms.
  /// 1 sigma of length() for the noise, and for what else it may be wrong by.
  double noise_sigma = std::numeric_limits<double>::infinity();
  double other_sigma = 0.0;

  NoisyLength() = default;
  /// From the squares of found and noise, and the variance of the first. Where the length is lost
  /// in the noise, its sigma is what it could be.
  NoisyLength(double square, double noise_square, double variance);

  /// Beyond the noise.
  double length() const;
  double sigma() const;
  /// An upper bound, to three sigma.
  double atMost() const;
};

}  // namespace camera_self_calibration
