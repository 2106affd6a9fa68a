#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/rig/rig_session.h"
#include "camera_self_calibration/rig_node/rig_node_options.h"
#include "camera_self_calibration/ros/calibration_store.h"

namespace camera_self_calibration {

/// A rig on the disk: for each camera the CameraInfo as camera_info_manager keeps it (of a
/// rectified pair: left.yaml and right.yaml for stereo_image_proc), and Kalibr's camchain; for the
/// next start what each camera has learnt, and the rig. A file that is somebody else's is never
/// written over. Thread-safe.
class RigStore {
 public:
  /// Where the options name no file: with `fallback` those that camera_info_manager would take and
  /// ${ROS_HOME}/camchain_NODE.yaml, else none. `name` is the node's.
  RigStore(const RigNodeOptions& options, const std::string& name, bool fallback);

  bool hasFile() const { return !stores_.empty() || !camchain_file_.empty(); }

  struct Loaded {
    std::optional<RigEstimate> rig;
    std::string note;     ///< What was taken from where; empty if nothing.
    std::string problem;  ///< What was refused, and why.
  };
  /// The rig as it was saved for these cameras.
  Loaded loadRig() const;

  /// What a camera had learnt, for images of this size.
  CalibrationStore::Loaded loadCamera(int camera, std::optional<CameraModel> model, int width,
                                      int height);

  /// `infos` and `states`: of each camera, as they go out at present, and what it has learnt (null:
  /// nothing yet). Refused for a rig that is not CONVERGED and, where states are kept, for one
  /// whose cameras have learnt another lens since the report.
  CalibrationStore::Outcome save(const RigReport& report,
                                 const std::vector<sensor_msgs::CameraInfo>& infos,
                                 const std::vector<std::shared_ptr<const LearntState>>& states);

  /// What the files that save() writes only approximate, a sentence for each camera.
  std::vector<std::string> notes(const RigReport& report) const;

 private:
  std::string saveCamchain(const RigReport& report) const;
  std::string saveRig(const RigReport& report) const;

  std::mutex mutex_;  // one save at a time
  std::vector<std::string> topics_;
  std::vector<std::unique_ptr<CalibrationStore>> stores_;  // one for each camera, or none
  std::string camchain_file_;
  std::vector<std::string> names_;
  std::string rig_file_;  // empty: nothing is kept for the next start
};

}  // namespace camera_self_calibration
