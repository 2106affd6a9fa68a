// The standalone node for rigs: for robots without a nodelet manager.

#include <ros/ros.h>

#include "camera_self_calibration/rig_node/rig_calibration_node.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "rig_calibration");
  const camera_self_calibration::RigCalibrationNode node(ros::NodeHandle(), ros::NodeHandle("~"),
                                                         ros::this_node::getName());
  ros::spin();
  return 0;
}
