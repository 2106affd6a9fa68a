#pragma once

#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

struct StartupOptions {
  int free_after_keyframes = 4;  ///< From so many keyframes on the intrinsics are estimated.
  double retry_cost = 1.3;       ///< Squared residual scale above which other guesses are tried.
  /// Likelihood ratio (chi-square, 1 degree of freedom) above which radtan's k3 is estimated too.
  double k3_likelihood_ratio = 40.0;
  double max_inverse_depth_ratio = 20.0;  ///< To the median; beyond, a depth starts over.
};

/// The batch solution from no knowledge (section II-C): all keyframes so far (up to what it is
/// given), all landmarks and the intrinsics, grown keyframe by keyframe so that each solve starts
/// near. Where the result does not fit the tracker's sigma, a small grid of other first guesses is
/// tried from the beginning. radtan starts with four distortion coefficients; k3 joins them when
/// the observations demand it.
class Startup {
 public:
  Startup(const StartupOptions& options, const Camera& initial);

  /// `segment` holds the newest keyframe and those before it; known ones keep their solution.
  void add(const Segment& segment);

  /// Starts again from these intrinsics at the next keyframe.
  void reset(const Camera& initial);

  const Camera& camera() const { return camera_; }
  /// Solved; poses and depths of the newest keyframes.
  const Segment& segment() const { return segment_; }
  bool usable() const { return usable_; }
  /// Scaled by the residuals where they exceed the tracker's sigma; n_c x n_c.
  const IntrinsicsMatrix& information() const { return information_; }
  /// Robust scale of the residuals against the tracker's own sigma (SegmentFit::residual_scale).
  double residualScale() const { return residual_scale_; }

 private:
  void keepKnown(Segment* segment) const;
  void tryOtherGuesses(const Segment& segment);
  void judge();
  void considerK3(const Segment& gated);

  StartupOptions options_;
  Camera initial_;
  Camera camera_;
  Segment segment_;
  IntrinsicsMatrix information_;
  double residual_scale_ = 1.0;
  bool usable_ = false;
  int added_ = 0;       // keyframes
  int next_retry_ = 0;  // count of keyframes at which other guesses are tried next
};

/// Solves a segment from no knowledge but `camera`'s guess, keyframe by keyframe (all poses and
/// depths in it are overwritten). Returns the final robust cost; infinite where it failed.
double bootstrap(const StartupOptions& options, Segment* segment, Camera* camera);

}  // namespace camera_self_calibration
