// The standalone node: for robots without a nodelet manager.

#include <ros/ros.h>

#include "camera_self_calibration/ros/self_calibration_node.h"
#include "camera_self_calibration/ros/usage.h"

namespace {

constexpr const char* kUsage =
    "Calibrates a camera while it runs: images in; CameraInfo, poses and the lens out. Needs a\n"
    "ROS master.\n"
    "\n"
    "  self_calibration_node image:=/camera/image_raw [_PARAMETER:=VALUE ...]\n"
    "\n"
    "Images: the topic `image`, or `image/compressed`; remap it to the camera's.\n"
    "Parameters: config/parameters.yaml explains each. Topics and services: doc/live.md.\n"
    "How the calibration goes is on /diagnostics.\n";

}  // namespace

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  if (printsUsage(argc, argv, kUsage)) return 0;
  ros::init(argc, argv, "self_calibration");
  const SelfCalibrationNode node(ros::NodeHandle(), ros::NodeHandle("~"),
                                 ros::this_node::getName());
  ros::spin();
  return 0;
}
