#pragma once

#include <image_transport/image_transport.h>
#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>

#include <functional>
#include <string>

#include "camera_self_calibration/ros/image_input.h"

namespace camera_self_calibration {

/// Publishes each image on arrival beside its CameraInfo, as a calibrated camera driver does:
/// image_raw (a raw image without a copy) and camera_info with the same header.
class CameraPublisher {
 public:
  /// The CameraInfo for an image of this header, width and height.
  using InfoFor = std::function<sensor_msgs::CameraInfo(const std_msgs::Header&, int, int)>;

  /// The topics stand below the name of `node`.
  CameraPublisher(const ros::NodeHandle& node, InfoFor info_for);

  /// What went wrong, in words; empty if nothing did. An image that cannot be read does not go out.
  std::string publish(const InputImage& image);

 private:
  std::string publishDecoded(const sensor_msgs::CompressedImage& message);

  const InfoFor info_for_;
  image_transport::Publisher image_;
  ros::Publisher camera_info_;
};

}  // namespace camera_self_calibration
