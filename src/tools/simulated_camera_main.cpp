// A rendered room as an ordinary camera: the node simulated_camera.

#include <ros/ros.h>

#include <memory>
#include <vector>

#include "camera_self_calibration/ros/usage.h"
#include "camera_self_calibration/tools/simulated_camera.h"

namespace {

constexpr const char* kUsage =
    "Renders a room and publishes it as an ordinary camera, with the truth beside it. Needs a ROS "
    "master.\n"
    "\n"
    "  simulated_camera [_PARAMETER:=VALUE ...]\n"
    "\n"
    "Parameters: model, intrinsics, width, height, rate [Hz], duration [s], readout [s],\n"
    "exposure [s], motion (handheld, planar, yaw_driving, rotation_only, forward_only,\n"
    "sideways_only, still), trajectory (TUM file), speed, seed, moving_share, carried_share,\n"
    "text_overlay, auto_exposure, frame_id, world_frame, publish_clock, wait_for,\n"
    "wait_limit [s], image_subscribers.\n"
    "Of a rig: cameras (names), and below each name what differs: the lens, mount (x, y, z [m] "
    "and\n"
    "rotation vector [degrees] on the body), bump_at [s] with bump (the same, in the camera's own\n"
    "frame), late [s] (how much after its stamps it takes images).\n"
    "Topics: image_raw, camera_info, truth/camera_info, truth/calibration, truth/pose,\n"
    "truth/finished; of a rig below the camera's name.\n";

}  // namespace

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  if (printsUsage(argc, argv, kUsage)) return 0;
  ros::init(argc, argv, "simulated_camera");
  const ros::NodeHandle node;
  try {
    std::vector<std::unique_ptr<SimulatedCamera>> cameras;
    for (const SimulationOptions& options : readSimulationOptions(ros::NodeHandle("~"))) {
      cameras.push_back(std::make_unique<SimulatedCamera>(node, options));
    }
    run(&cameras);
    ros::spin();
    return 0;
  } catch (const std::exception& e) {
    ROS_FATAL_STREAM("simulated_camera: " << e.what());
    return 1;
  }
}
