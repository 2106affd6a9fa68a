#pragma once

#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/reference/batch.h"

namespace camera_self_calibration {

/// What is wrong with the input of solveBatch, in one sentence; empty if nothing is.
std::string inputProblem(const std::vector<BatchSegment>& segments, const Camera& camera);

}  // namespace camera_self_calibration
