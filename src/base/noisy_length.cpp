#include "camera_self_calibration/base/noisy_length.h"

#include <algorithm>
#include <cmath>

namespace camera_self_calibration {
namespace {

constexpr double kSigmas = 3.0;  // of atMost()

}  // namespace

NoisyLength::NoisyLength(double square, double noise_square, double variance)
    : found(std::sqrt(square)), noise(std::sqrt(noise_square)) {
  const double reach = std::max(found, noise);
  noise_sigma = reach > 0.0 ? std::sqrt(std::max(0.0, variance)) / (2.0 * reach) : 0.0;
}

double NoisyLength::length() const {
  if (!std::isfinite(found)) return found;
  return std::sqrt(std::max(0.0, found * found - noise * noise));
}

double NoisyLength::sigma() const { return std::hypot(noise_sigma, other_sigma); }

// Beyond the noise the length is about normal, and in it its square.
double NoisyLength::atMost() const {
  const double own = length();
  if (!std::isfinite(own)) return own;
  const double squares = own * own + 2.0 * kSigmas * std::max(found, noise) * noise_sigma;
  const double bound = std::max(found + kSigmas * noise_sigma, std::sqrt(squares));
  return own + std::hypot(bound - own, kSigmas * other_sigma);
}

}  // namespace camera_self_calibration
