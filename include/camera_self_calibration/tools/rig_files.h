#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/rig/rig_estimate.h"

namespace camera_self_calibration {

/// Kalibr's camchain of all cameras: intrinsics (fitted where Kalibr does not have the model, which
/// a comment tells) and `T_cn_cnm1`, the motion from the camera before to each, with `comment` as
/// its first line. Throws std::runtime_error where no model of Kalibr's fits.
std::string rigCamchain(const Rig& rig, const std::vector<std::string>& topics,
                        const std::string& comment);

/// Which cameras the camchain in `file` holds an approximation of, a sentence for each. Throws as
/// rigCamchain().
std::vector<std::string> camchainNotes(const Rig& rig, const std::string& file);

/// In words, in what unit lengths are: for people who read a file.
std::string scaleNote(const RigEstimate& estimate);

/// A pair of cameras as stereo_image_proc reads it.
struct StereoPair {
  int left = 0;  ///< Index of the left camera.
  int right = 1;
  sensor_msgs::CameraInfo left_info;   ///< R and P of the rectified image.
  sensor_msgs::CameraInfo right_info;  ///< The same; P has Tx = -f * baseline.
  PixelError left_error;               ///< Of D and K, from the lens [px]; 0 where they are exact.
  PixelError right_error;
};

/// The rectified pair of a rig of two cameras of one image size (cv::stereoRectify, or that of
/// cv::fisheye where a lens is no plumb_bob). Nothing with a reason in `problem` (never null) where
/// there is none: other than two cameras, sizes that differ, cameras that stand one above the
/// other, one behind the other, or look different ways, or have no distortion model in common.
std::optional<StereoPair> stereoPair(const Rig& rig, std::string* problem);

/// A sentence on `holder`, such as left.yaml, that has the CameraInfo of one of a pair: what it has
/// in place of the lens, which it is off by `error`. Empty where it is exact.
std::string stereoNote(const std::string& holder, const sensor_msgs::CameraInfo& info,
                       const PixelError& error);

}  // namespace camera_self_calibration
