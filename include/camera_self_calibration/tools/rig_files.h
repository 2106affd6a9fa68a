#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/rig/rig_estimate.h"

namespace camera_self_calibration {

/// Kalibr's camchain of all cameras: intrinsics (fitted where Kalibr does not have the model) and
/// `T_cn_cnm1`, the motion from the camera before to each, with `comment` as its first line.
std::string rigCamchain(const Rig& rig, const std::vector<std::string>& topics,
                        const std::string& comment);

/// In words, in what unit lengths are: for people who read a file.
std::string scaleNote(const RigEstimate& estimate);

/// A pair of cameras as stereo_image_proc reads it.
struct StereoPair {
  int left = 0;  ///< Index of the left camera.
  int right = 1;
  sensor_msgs::CameraInfo left_info;   ///< R and P of the rectified image.
  sensor_msgs::CameraInfo right_info;  ///< The same; P has Tx = -f * baseline.
};

/// The rectified pair of a rig of two cameras of one image size (cv::stereoRectify, or that of
/// cv::fisheye where a lens is no plumb_bob). Nothing with a reason in `problem` (never null) where
/// there is none: other than two cameras, sizes that differ, cameras that stand one above the
/// other, one behind the other, or look different ways.
std::optional<StereoPair> stereoPair(const Rig& rig, std::string* problem);

}  // namespace camera_self_calibration
