#pragma once

#include <image_transport/image_transport.h>
#include <ros/node_handle.h>

#include <string>

#include "camera_self_calibration/ros/camera_info_policy.h"
#include "camera_self_calibration/ros/image_input.h"

namespace camera_self_calibration {

/// Publishes each image on arrival beside its CameraInfo, as a calibrated camera driver does:
/// ~image_raw (a raw image without a copy) and ~camera_info with the same header.
class CameraPublisher {
 public:
  CameraPublisher(const ros::NodeHandle& private_node, const CameraInfoPolicy* camera_info);

  /// What went wrong, in words; empty if nothing did. An image that cannot be read does not go out.
  std::string publish(const InputImage& image);

 private:
  std::string publishDecoded(const sensor_msgs::CompressedImage& message);

  const CameraInfoPolicy* policy_;
  image_transport::Publisher image_;
  ros::Publisher camera_info_;
};

}  // namespace camera_self_calibration
