#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/rig/rig_convergence.h"
#include "camera_self_calibration/rig/rig_self_calibrator.h"
#include "camera_self_calibration/rig_node/rig_camera_info.h"
#include "camera_self_calibration/rig_node/rig_node_options.h"
#include "camera_self_calibration/rig_node/rig_store.h"
#include "camera_self_calibration/ros/camera_publisher.h"
#include "camera_self_calibration/ros/image_input.h"
#include "camera_self_calibration/ros/input_monitor.h"
#include "camera_self_calibration/ros/node_log.h"
#include "camera_self_calibration/ros/publisher_watch.h"

namespace camera_self_calibration {

/// The interface of a RigSelfCalibrator to ROS, the same in the nodelet and the standalone node.
/// Topics and parameters are listed in doc/rigs.md. With wrong parameters it stays idle and says
/// so, in the log and on /diagnostics. All callbacks are expected on one thread at a time.
class RigCalibrationNode {
 public:
  /// Returns at once and does not throw. `name` stands in /diagnostics.
  RigCalibrationNode(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                     const std::string& name);
  ~RigCalibrationNode();

 private:
  /// What belongs to one camera.
  struct Port {
    std::unique_ptr<ImageInput> input;
    std::unique_ptr<CameraPublisher> publisher;
    ros::Publisher extrinsics;
    PublisherWatch watch;
    InputMonitor monitor;
    bool restored = false;  // from what was learnt before, if anything was
    // What follows is read by other threads, under mutex_.
    InputCounts counts;
    std::string frame;  // of its images
    ros::WallTime last_image;
    std::int64_t dropped = 0;
    std::int64_t dropped_before = 0;  // when /diagnostics last told
    std::int64_t rejected_before = 0;
  };

  void start(const std::string& name);
  void addPort(int camera);
  void loadRig();
  void restoreCamera(int camera, int width, int height);
  void onImage(int camera, InputImage image);
  void onReport(const RigReport& report);
  void keep(const RigReport& report);
  void saveAgain();
  void publishPlaces(const RigReport& report);
  std::string frameOf(int camera) const;
  void raise(const Event& event, const std::string& who);
  bool save(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  CalibrationStore::Outcome saveTo(RigStore* store, const RigReport& report);
  void describe(diagnostic_updater::DiagnosticStatusWrapper& status);
  void warnOfNotes(const RigStore& store, const RigReport& report);
  std::string inputProblem();

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  NodeLog log_;
  RigNodeOptions options_;
  std::string idle_;  // why nothing is done, in a sentence; empty if something is
  diagnostic_updater::Updater updater_;
  ros::WallTimer timer_;
  ros::Publisher event_;
  std::unique_ptr<tf2_ros::StaticTransformBroadcaster> transforms_;

  std::vector<std::unique_ptr<Port>> ports_;
  std::unique_ptr<RigCameraInfo> camera_info_;
  std::unique_ptr<RigStore> store_;
  std::unique_ptr<RigStore> fallback_store_;
  std::optional<RigEstimate> loaded_rig_;  // until it is restored
  int cameras_restored_ = 0;

  std::mutex report_mutex_;  // one report at a time, for what follows
  std::uint64_t published_revision_ = 0;
  std::uint64_t tried_revision_ = 0;  // to save
  std::uint64_t saved_revision_ = 0;
  RigConvergence convergence_;
  bool closing_ = false;  // nothing is to be told any more

  std::atomic<bool> notes_told_{false};  // those of the stores

  mutable std::mutex mutex_;  // for what follows, and in ports_
  std::string saving_;        // how the newest one ended
  bool saving_failed_ = false;

  std::unique_ptr<RigSelfCalibrator> calibrator_;
  ros::CallbackQueue service_queue_;
  ros::ServiceServer save_;
  ros::WallTimer save_timer_;
  std::unique_ptr<ros::AsyncSpinner> service_spinner_;
};

}  // namespace camera_self_calibration
