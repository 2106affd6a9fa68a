#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <memory>
#include <string>
#include <vector>

#include "camera_self_calibration/rig/rig_session.h"
#include "camera_self_calibration/rig_node/rig_node_options.h"
#include "camera_self_calibration/ros/calibration_store.h"

namespace camera_self_calibration {

/// A rig on the disk: for each camera the CameraInfo as camera_info_manager keeps it (of a
/// rectified pair: left.yaml and right.yaml for stereo_image_proc), and Kalibr's camchain. A file
/// that is somebody else's is never written over. Thread-safe.
class RigStore {
 public:
  /// Where the options name no file: with `fallback` those that camera_info_manager would take and
  /// ${ROS_HOME}/camchain_NODE.yaml, else none. `name` is the node's.
  RigStore(const RigNodeOptions& options, const std::string& name, bool fallback);

  bool hasFile() const { return !stores_.empty() || !camchain_file_.empty(); }

  /// `infos`: as they go out at present. Of a rig that is not CONVERGED nothing is written.
  CalibrationStore::Outcome save(const RigReport& report,
                                 const std::vector<sensor_msgs::CameraInfo>& infos);

 private:
  std::string saveCamchain(const RigReport& report) const;

  std::vector<std::string> topics_;
  std::vector<std::unique_ptr<CalibrationStore>> stores_;  // one for each camera, or none
  std::string camchain_file_;
};

}  // namespace camera_self_calibration
