#pragma once

#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "camera_self_calibration/rig/rig_calibrator.h"
#include "camera_self_calibration/ros/node_options.h"

namespace camera_self_calibration {

/// The parameters of the node for rigs; config/rig.yaml explains each.
struct RigNodeOptions {
  NodeOptions camera;                     ///< What all cameras have in common.
  std::vector<std::string> image_topics;  ///< One for each camera, two to six.
  std::vector<std::string> camera_names;  ///< One for each; those not given: cam0, cam1, ...
  /// Optical frame of each camera in tf; empty: the frame_id of its images.
  std::vector<std::string> camera_frames;
  double baseline = 0.0;                      ///< Between the first two cameras [m]; 0: not known.
  int rig_keyframes = 240;                    ///< Kept, with their images.
  bool publish_tf = false;                    ///< Where the cameras sit, on /tf_static.
  std::vector<std::string> camera_info_urls;  ///< One for each camera; empty: nothing is saved.
  std::string camchain_file;                  ///< Path or URL; empty: none.
  std::string state_folder;  ///< What is learnt, for the next start; path or URL; empty: none.

  int cameras() const { return static_cast<int>(image_topics.size()); }
  RigOptions rig() const;

  /// Every violated bound in one sentence each.
  std::vector<std::string> problems() const;
};

using RigNodeOptionsReading = OptionsReading<RigNodeOptions>;

/// Reads the private parameters; what is absent keeps its default.
RigNodeOptionsReading readRigNodeOptions(const ros::NodeHandle& private_node);

}  // namespace camera_self_calibration
