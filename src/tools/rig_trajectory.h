#pragma once

#include <vector>

#include "camera_self_calibration/rig/rig_estimate.h"
#include "camera_self_calibration/tools/recording.h"

namespace camera_self_calibration {

/// The way of the first camera, image by image, put onto the rig's keyframes: each image stands to
/// the keyframe before it as in the camera's own map, in the rig's unit. Images before the first
/// keyframe stand to that one. Segments of one map continue each other.
std::vector<TimedPose> onRig(const std::vector<TimedPose>& way, const std::vector<RigPose>& poses);

}  // namespace camera_self_calibration
