#pragma once

#include "camera_self_calibration/estimation/problem.h"

namespace camera_self_calibration {

/// The block of a segment that conditions on nothing: first pose fixed, and one inverse depth,
/// which sets the scale. As the paper, among the landmarks with most observations; of those, the
/// one whose depth is determined best (largest rho^2 H_rhorho), since a far point does not fix the
/// scale. The intrinsics' marginal does not depend on the choice. `fixed_landmark` is -1 where
/// there is no landmark.
SegmentBlock freeBlock(Segment* segment, const Camera& camera);

}  // namespace camera_self_calibration
