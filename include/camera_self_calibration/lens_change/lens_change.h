#pragma once

#include <limits>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/map/segment.h"
#include "camera_self_calibration/queue/agreement.h"

namespace camera_self_calibration {

/// The hypothesis that the lens changed within a segment of video, against the one that it did not.
struct LensChange {
  bool usable = false;           ///< There is a solution.
  Segment segment;               ///< Solved under the change, outliers removed.
  Camera camera;                 ///< After the change.
  IntrinsicsMatrix information;  ///< Of `camera`, given the one before.
  double residual_scale = 1.0;   ///< Under the change, against the tracker's own sigma.
  /// Likelihood ratio against one lens throughout, the reference's uncertainty considered; the
  /// smaller of its exact value and its quadratic approximation. Chi-square with n_c degrees of
  /// freedom if nothing changed.
  double statistic = 0.0;
  double p_value = 1.0;
};

/// Solves the segment with the reference's intrinsics for its first `earlier_keyframes` keyframes
/// (0: none) and free ones for the others, and compares with one set of intrinsics for all. The
/// known structure makes few keyframes after a change suffice. What speaks for a change has to do
/// so in fittingOneLens(), too: `statistic` is the smaller one.
LensChange testLensChange(const Segment& segment, int earlier_keyframes,
                          const Reference& reference);

/// The segment as one lens throughout explains it best: solved with the intrinsics of `camera` from
/// its own state and from one without depths and translations, without the 15 % of its tracks that
/// fit worst. A change of the lens moves nearly all tracks: one that shows only in those is feigned
/// by outliers, and one that vanishes from another start by a wrong minimum. Its gauge may be
/// another than that of `segment`.
Segment fittingOneLens(const Segment& segment, const Camera& camera);

/// The most likely time of a change within the segment: how many of its keyframes came before it
/// (0: the whole segment shows another lens than the reference). Each number from `first` to `last`
/// that leaves a keyframe for the new lens is tried, and the costs compared.
int dateLensChange(const Segment& segment, const Reference& reference, int first = 0,
                   int last = std::numeric_limits<int>::max());

}  // namespace camera_self_calibration
