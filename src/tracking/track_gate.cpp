#include "camera_self_calibration/tracking/track_gate.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/base/median.h"

namespace camera_self_calibration {
namespace {

// [px] A worse position tells no more than the flow, whose way back may miss by a pixel in all.
constexpr double kMaxSigma = 0.7;
// Left over by the same corner: variance against that of the noise, and of the patch's contrast, by
// the warp model.
constexpr double kNoiseFactor = 3.0;
constexpr double kContrastShare = 0.005;
// Of the contrast, beyond noise: where a silhouette shows more of what is behind, its pull is more
// often wrong than its sigma says.
constexpr double kMaxMisfitShare = 0.03;
// Of the contrast that is seen, left over by noise and all else: of two patches of nothing but
// noise no registration explains half.
constexpr double kMaxUnexplained = 0.5;
constexpr double kMinGain = 0.2;
constexpr double kMaxGain = 5.0;

// The parameters fit a part of the noise; from simulation, with what smoothing adds to it.
constexpr double kResidualFactor = 1.2;
// Variance of white noise against what smoothing leaves of it in the residual; from simulation.
constexpr double kWhiteFactor = 4.0;
constexpr double kFloor =
    0.006;  // [px of the patch] What the warp model and the interpolation leave.
// What noise does not explain is alike over several pixels, and displaces more than as much noise.
constexpr double kMisfitFactor = 1.5;
// [px of the patch] Between two things that one patch shows: the share of its contrast that is not
// its own pulls it by that share of this. Both are from the residuals of real tracks after bundle
// adjustment.
constexpr double kDisplacement = 10.0;

constexpr double kMinContrast = 1.0;  // [gray^2] Below lies the noise of any camera.

constexpr int kMinSample = 8;  // Registrations to learn the noise from.
constexpr double kForget = 0.1;

}  // namespace

// What noise does not explain of the difference left over.
double TrackGate::misfit(const Registration& registration) const {
  return std::max(0.0, kResidualFactor * registration.residual - noise_);
}

double TrackGate::sigma(const Registration& registration) const {
  const double beyond = misfit(registration);
  const double variance =
      0.5 * registration.unit_covariance.trace() * kWhiteFactor * (noise_ + kMisfitFactor * beyond);
  const double pull =
      pixel_ * kDisplacement * beyond / std::max(registration.contrast, kMinContrast);
  const double floor = pixel_ * kFloor;
  return std::sqrt(variance + pull * pull + floor * floor);
}

double TrackGate::whiteNoise() const { return kWhiteFactor * noise_; }

bool TrackGate::accepts(const Registration& registration) const {
  return registration.status == Registration::Status::kGood && registration.gain > kMinGain &&
         registration.gain < kMaxGain &&
         registration.residual <= kMaxUnexplained * registration.contrast &&
         misfit(registration) <= kMaxMisfitShare * registration.contrast &&
         sigma(registration) <= kMaxSigma;
}

bool TrackGate::looksTheSame(const Registration& registration) const {
  return registration.residual <= kNoiseFactor * noise_ + kContrastShare * registration.contrast;
}

void TrackGate::learn(const std::vector<Registration>& registrations) {
  if (registrations.size() < kMinSample) return;
  residuals_.clear();
  for (const Registration& r : registrations) residuals_.push_back(r.residual);
  const double noise = kResidualFactor * medianInPlace(&residuals_);
  const double rate = std::max(kForget, 1.0 / ++images_);
  noise_ += rate * (noise - noise_);
}

}  // namespace camera_self_calibration
