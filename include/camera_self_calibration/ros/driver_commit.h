#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>

#include <string>

namespace camera_self_calibration {

/// What a camera driver answered, or why it could not be asked.
struct CommitOutcome {
  bool success = false;
  std::string message;
};

/// Hands a calibration over to the camera's driver through its service `set_camera_info`. Returns
/// after `timeout_s` at the latest, also if the driver never answers. Not to be called from the
/// thread that would have to serve the driver.
CommitOutcome commitToDriver(const ros::NodeHandle& node, const std::string& service,
                             const sensor_msgs::CameraInfo& info, double timeout_s);

/// The service of the driver that publishes an image topic: "/camera/set_camera_info" for
/// "/camera/image_raw".
std::string driverService(const std::string& image_topic);

}  // namespace camera_self_calibration
