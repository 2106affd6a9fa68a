#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <optional>
#include <string>

#include "camera_self_calibration/camera/fit.h"

namespace camera_self_calibration {

/// The camera of `model` that a CameraInfo describes, exactly if the message's own model is that
/// one or a special case of it, else fitted. Nothing where the message is uncalibrated, of an
/// unknown distortion model, implausible (implausibility()), or cannot be fitted over the whole
/// image. Without a model: in the message's own.
std::optional<CameraFit> startFrom(const sensor_msgs::CameraInfo& info,
                                   std::optional<CameraModel> model);

/// Why a CameraInfo describes no camera, whatever the model asked for, as the end of a sentence
/// that begins with what holds the message: "it is uncalibrated: its K is zero". Empty where it
/// may.
std::string whyNoCamera(const sensor_msgs::CameraInfo& info);

/// Why startFrom() gives nothing, in the same form as whyNoCamera().
std::string whyNoStart(const sensor_msgs::CameraInfo& info, std::optional<CameraModel> model);

}  // namespace camera_self_calibration
