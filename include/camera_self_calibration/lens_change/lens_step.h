#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "camera_self_calibration/queue/agreement.h"

namespace camera_self_calibration {

/// A step of the focal length.
struct LensStep {
  /// Bounds the probability, were the lens constant, of ever finding so much: the likelihood ratio
  /// of a constant lens to a step, averaged over when it came and how large it was.
  double p_value = 1.0;
  std::int64_t onset_ns = 0;     ///< Beginning of the first segment after it.
  Camera camera;                 ///< What the segments after it say of all intrinsics together.
  IntrinsicsMatrix information;  ///< Of `camera`, n_c x n_c.
};

/// Whether disjoint segments show one step of the focal length: segment i shows the intrinsics
/// `x + (fx, fy, 0, ..) s`, where it comes before the step, else x. Found where a constant lens has
/// a p-value below `limit`, no single segment decides, and a step is clearly likelier than any slow
/// drift: a random walk (driftEvidence) or a ramp that goes on until now. Unlike a test of the
/// newest segments against the queue it does not mind that the queue took some from after the
/// step for its own. `segments`, in any order, are of the intrinsics of `camera`.
std::optional<LensStep> estimateStep(std::vector<QuadraticLikelihood> segments,
                                     const Camera& camera, std::int64_t now_ns, double limit);

/// Whether such segments show that the focal length drifts: a drift is clearly likelier than a
/// constant lens, and a step not clearly likelier than a drift.
bool showsDrift(std::vector<QuadraticLikelihood> segments, const Camera& camera,
                std::int64_t now_ns);

}  // namespace camera_self_calibration
