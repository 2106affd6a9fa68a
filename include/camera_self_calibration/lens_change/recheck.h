#pragma once

#include <string>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

enum class RecheckVerdict { kUndecided, kSame, kDifferent };

struct RecheckOptions {
  int min_keyframes = 8;
  /// Probability of so large a likelihood ratio without a change, per look.
  double false_alarm = 1e-9;
  double sigmas = 4.0;      ///< Distances below so many of their expectation are no difference.
  double thresholds = 4.0;  ///< Nor are those below so many thresholds: the queue takes them in.
};

/// What is known so far of a calibration that was not learnt from these images.
struct RecheckEvidence {
  Camera known;               ///< The calibration in question.
  PixelError known_error;     ///< Its stated uncertainty [px].
  Camera fresh;               ///< Estimated from `segment` alone.
  PixelError fresh_error;     ///< Its stated uncertainty [px].
  ImageField field;           ///< The part of the image that these are over.
  double threshold_px = 1.0;  ///< rms below which a calibration counts as converged.
};

struct Recheck {
  RecheckVerdict verdict = RecheckVerdict::kUndecided;
  double likelihood_ratio = 0.0;  ///< Chi-square with n_c degrees of freedom if nothing changed.
  double distance_px = 0.0;       ///< Between the two calibrations, rms.
  std::string sentence;           ///< The outcome in words.
};

/// Whether images come from the lens that a known calibration describes. Two conditions for
/// "different", so that neither a wrong minimum nor a tiny drift is taken for another lens: the new
/// observations fit the known intrinsics significantly worse than free ones,
/// `2 (cost with the known - cost with free) > chi-square quantile`, both from the same state, with
/// the same observations and sigmas; and the two calibrations differ by more than their uncertainty
/// and the thresholds. Undecided while the images do not tell enough. `segment` holds the new
/// keyframes, solved with `fresh`.
Recheck recheckCalibration(const RecheckOptions& options, const RecheckEvidence& evidence,
                           const Segment& segment);

}  // namespace camera_self_calibration
