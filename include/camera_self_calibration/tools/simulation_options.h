#pragma once

#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "camera_self_calibration/simulation/simulated_sequence.h"

namespace camera_self_calibration {

/// What simulated_camera shows and how.
struct SimulationOptions {
  std::string name;  ///< Namespace of the topics; empty: that of the node.
  SequenceOptions sequence;
  std::string frame_id = "simulated_camera";   ///< Of the images.
  std::string world_frame = "simulated_room";  ///< Of the true poses.
  bool publish_clock = false;  ///< Drives /clock (with use_sim_time) by the stamps of the images.
  /// Topic of TrackingStatus: the next image comes when the last one is done. Empty: the camera
  /// waits for nobody.
  std::string wait_for;
  int image_subscribers = 1;  ///< With wait_for: the first image waits for this many.
  double wait_limit_s = 2.0;  ///< Per image; longer delays are not waited for [s].
};

/// Reads the private parameters of simulated_camera: one camera, or those of a rig that `cameras`
/// names, on one body. Throws std::runtime_error that lists every problem.
std::vector<SimulationOptions> readSimulationOptions(const ros::NodeHandle& private_node);

}  // namespace camera_self_calibration
