// A rendered room as an ordinary camera: the node simulated_camera.

#include <ros/ros.h>

#include "camera_self_calibration/tools/simulated_camera.h"

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  ros::init(argc, argv, "simulated_camera");
  const ros::NodeHandle node;
  try {
    SimulatedCamera camera(node, readSimulationOptions(ros::NodeHandle("~")));
    camera.run();
    ros::spin();
    return 0;
  } catch (const std::exception& e) {
    ROS_FATAL_STREAM("simulated_camera: " << e.what());
    return 1;
  }
}
