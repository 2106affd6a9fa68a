#include "camera_self_calibration/tracking/track_gate.h"

#include <algorithm>
#include <cmath>

namespace camera_self_calibration {
namespace {

constexpr double kMaxSigma = 0.3;         // [px] A worse position is of no use.
constexpr double kNoiseFactor = 3.0;      // Variance left over against that of the noise.
constexpr double kContrastShare = 0.005;  // Of the patch's variance, left over by the warp model.
constexpr double kMinGain = 0.2;
constexpr double kMaxGain = 5.0;

// The parameters fit a part of the noise; from simulation, with what smoothing adds to it.
constexpr double kResidualFactor = 1.2;
// Variance of white noise against what smoothing leaves of it in the residual; from simulation.
constexpr double kWhiteFactor = 4.0;
constexpr double kFloor = 0.006;  // [px] What the warp model and the interpolation leave.

constexpr int kMinSample = 8;  // Registrations to learn the noise from.
constexpr double kForget = 0.1;

}  // namespace

double TrackGate::sigma(const Registration& registration) const {
  const double noise = std::max(noise_, kResidualFactor * registration.residual);
  const double variance = 0.5 * registration.unit_covariance.trace() * kWhiteFactor * noise;
  return std::sqrt(variance + kFloor * kFloor);
}

double TrackGate::whiteNoise() const { return kWhiteFactor * noise_; }

bool TrackGate::accepts(const Registration& registration) const {
  if (registration.status != Registration::Status::kGood) return false;
  if (!(registration.gain > kMinGain && registration.gain < kMaxGain)) return false;
  const double explained = kNoiseFactor * noise_ + kContrastShare * registration.contrast;
  return registration.residual <= explained && sigma(registration) <= kMaxSigma;
}

void TrackGate::learn(const std::vector<Registration>& registrations) {
  if (registrations.size() < kMinSample) return;
  residuals_.clear();
  for (const Registration& r : registrations) residuals_.push_back(r.residual);
  const auto middle = residuals_.begin() + static_cast<std::ptrdiff_t>(residuals_.size() / 2);
  std::nth_element(residuals_.begin(), middle, residuals_.end());
  const double noise = kResidualFactor * *middle;
  const double rate = std::max(kForget, 1.0 / ++images_);
  noise_ += rate * (noise - noise_);
}

}  // namespace camera_self_calibration
