#pragma once

#include <vector>

#include "camera_self_calibration/tracking/patch_registration.h"

namespace camera_self_calibration {

/// Decides whether registrations of the patches of one level are to be believed, and how precise
/// they are. Learns the noise of the level's gray values from what registrations leave over.
class TrackGate {
 public:
  /// For patches whose pixels have this width in the image [px].
  explicit TrackGate(double pixel = 1.0) : pixel_(pixel) {}

  void reset() { *this = TrackGate(pixel_); }

  /// Standard deviation of the registered pixel per axis [px]: by noise, and by what the patch
  /// shows now that is not in its reference, such as a nearer surface at its side.
  double sigma(const Registration& registration) const;

  /// Whether the patch is still the same piece of the world. A difference that is left over makes
  /// the position less certain first, and ends the track when it says nothing any more.
  bool accepts(const Registration& registration) const;

  /// Whether the difference left over is explained by noise and by a share of the patch's contrast
  /// that another corner, however alike, would exceed.
  bool looksTheSame(const Registration& registration) const;

  /// Learns from the accepted registrations of one image.
  void learn(const std::vector<Registration>& registrations);

  /// Variance of the difference between two registered patches that is due to noise [gray^2].
  double noise() const { return noise_; }

  /// That of white noise with the same effect on a registration: smoothing hides a part of it.
  double whiteNoise() const;

 private:
  double misfit(const Registration& registration) const;

  double pixel_;
  double noise_ = 1.0;
  int images_ = 0;
  std::vector<double> residuals_;
};

}  // namespace camera_self_calibration
