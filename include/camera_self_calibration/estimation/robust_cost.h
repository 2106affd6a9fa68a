#pragma once

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/problem.h"
#include "camera_self_calibration/estimation/transfer.h"

namespace camera_self_calibration {

/// The robust cost of one block at its present state, as LinearSegment::cost. `transfers` lends
/// memory.
double robustCost(const SegmentBlock& block, const Camera& camera, double huber,
                  Transfers* transfers);
double robustCost(const SegmentBlock& block, const Camera& camera, double huber);

}  // namespace camera_self_calibration
