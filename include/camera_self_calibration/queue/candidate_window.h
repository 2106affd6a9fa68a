#pragma once

#include <string>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// What one segment of the trajectory, by itself, says about the intrinsics.
struct Candidate {
  Segment observed;              ///< As it was offered.
  Segment segment;               ///< Solved, outliers removed.
  Camera camera;                 ///< Its own estimate.
  double sigma_scale = 1.0;      ///< By which its observations' sigmas were multiplied.
  IntrinsicsMatrix information;  ///< Marginal, with the scaled sigmas; n_c x n_c.
  double cost = 0.0;             ///< Robust, at its own optimum, with the scaled sigmas.
  double entropy = 0.0;          ///< Normalised [nats].
  PixelError uncertainty;        ///< [px]
  double residual_scale = 1.0;   ///< Against the tracker's own sigma.
  bool well_posed = false;
  std::string reason;  ///< Why it is not well posed, for people.
};

struct CandidateOptions {
  int min_keyframes = 5;
  int min_landmarks = 20;
  /// Of the marginal information with a unit diagonal.
  double min_scaled_eigenvalue = kUnobservedEigenvalue;
  /// rms over the image's longer side, above which it is ill posed.
  double max_pixel_uncertainty_share = kUselessUncertaintyShare;
  /// Sigmas that the intrinsics would still move (Marginal::remainingStep). Poses and depths that
  /// nothing determines, as in pure rotation, never settle and do not matter.
  double max_remaining_step = 0.5;
  double max_residual_scale = 6.0;  ///< Against the tracker's own sigma.
};

/// Scores a segment (section II-B): intrinsics, poses and landmarks are estimated from it alone,
/// starting from `start`, conditioning on nothing, and the intrinsics' marginal gives the entropy.
Candidate evaluateCandidate(const CandidateOptions& options, const Segment& segment,
                            const Camera& start);

}  // namespace camera_self_calibration
