// The standalone node: for robots without a nodelet manager.

#include <ros/ros.h>

#include "camera_self_calibration/ros/self_calibration_node.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "self_calibration");
  const camera_self_calibration::SelfCalibrationNode node(ros::NodeHandle(), ros::NodeHandle("~"),
                                                          ros::this_node::getName());
  ros::spin();
  return 0;
}
