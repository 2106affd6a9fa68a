#pragma once

#include <cstddef>
#include <vector>

#include "camera_self_calibration/queue/agreement.h"

namespace camera_self_calibration {

/// How segments of video came to disagree with a reference.
struct ChangeCourse {
  bool gradual = false;          ///< A ramp; else a step.
  std::size_t first = 0;         ///< The first segment after the beginning of the change.
  Camera camera;                 ///< At the last segment.
  IntrinsicsMatrix information;  ///< Of `camera`, n_c x n_c.
};

/// Whether a step or a ramp explains more of the disagreement of disjoint segments, in the order
/// of time, with the reference. Either begins between two of them and has n_c parameters: the
/// change of the intrinsics, or their change per second. A ramp needs three segments.
ChangeCourse courseOfChange(const std::vector<QuadraticLikelihood>& segments,
                            const Reference& reference);

}  // namespace camera_self_calibration
