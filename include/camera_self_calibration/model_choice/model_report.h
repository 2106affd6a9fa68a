#pragma once

#include <string>

#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {

/// Share of the image without rays up to which a calibration still is one of the image. Under
/// radtan the outermost corners of a strongly distorted lens have none (3 % on one of 100 degrees
/// that it fits to 0.1 px elsewhere); on a lens of 125 degrees, which it does not fit, 10 %.
constexpr double kNegligibleRim = 0.05;

/// Whether the model in use describes the lens, by the newest comparison with richer ones.
struct LensFitReport {
  bool compared = false;  ///< Else nothing is known yet.
  std::string model;      ///< The one in use.
  bool refuted = false;   ///< `model` misses the lens, beyond chance.
  std::string better;     ///< Describes the lens where `model` misses it; empty: none does better.
  /// What the lens that does best adds to the expected error of the lens in use, whether it refutes
  /// that one or not, a rotation of the camera removed, over the image [px]: s^2 distance^2 between
  /// the two + s (uncertainty^2 of the other one - uncertainty^2 of the lens in use), with the
  /// share s of their difference that is beyond chance (shareBeyondChance). Pixels without a ray,
  /// unless they are a negligible rim, count like observations that cannot be predicted
  /// (kUnpredictableResidualPx).
  PixelError misfit;
  PixelError misfit_observed;  ///< The same over the part of the image that features covered.
  /// Share of the image that has rays under the other model and none under the one in use, times s.
  double undescribed = 0.0;

  /// Whether `model` has rays for the image but for a negligible rim.
  bool describesImage() const;
  /// In words; empty before the first comparison.
  std::string sentence() const;
};

/// What speaks against a model, compared with the one in use.
struct ModelEvidence {
  std::string model;  ///< LensTrial::name
  bool chosen = false;
  /// By how much the model in use explains the observations better: difference of their costs over
  /// LensKnowledge::variance [nats]; negative where this model is ahead; infinite where it fits
  /// nothing.
  double behind = 0.0;
};

}  // namespace camera_self_calibration
