// The standalone node for rigs: for robots without a nodelet manager.

#include <ros/ros.h>

#include "camera_self_calibration/rig_node/rig_calibration_node.h"
#include "camera_self_calibration/ros/usage.h"

namespace {

constexpr const char* kUsage =
    "Calibrates two to six cameras that are fixed to each other while they run: images in;\n"
    "CameraInfo and the places of the cameras out. Needs a ROS master.\n"
    "\n"
    "  rig_calibration_node _image_topics:=\"[/left/image_raw, /right/image_raw]\" "
    "[_PARAMETER:=VALUE ...]\n"
    "\n"
    "Images: the topics that the parameter image_topics names, one for each camera.\n"
    "Parameters: config/rig.yaml and config/parameters.yaml explain each. Topics and services:\n"
    "doc/rigs.md. How the calibration goes is on /diagnostics.\n";

}  // namespace

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  if (printsUsage(argc, argv, kUsage)) return 0;
  ros::init(argc, argv, "rig_calibration");
  const RigCalibrationNode node(ros::NodeHandle(), ros::NodeHandle("~"), ros::this_node::getName());
  ros::spin();
  return 0;
}
