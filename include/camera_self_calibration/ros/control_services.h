#pragma once

#include <camera_self_calibration/SetScale.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <sensor_msgs/SetCameraInfo.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/ros/calibration_store.h"
#include "camera_self_calibration/ros/camera_info_policy.h"
#include "camera_self_calibration/ros/size_memory.h"

namespace camera_self_calibration {

/// What the services work on. All functions are called from the services' own thread.
struct ControlTargets {
  /// Calls its argument with the running calibrator; false if there is none, since no image has
  /// come.
  std::function<bool(const std::function<void(SelfCalibrator&)>&)> with_calibrator;
  /// The CameraInfo that goes out at present; K[0] is 0 if uncalibrated.
  std::function<sensor_msgs::CameraInfo()> published_info;
  CameraInfoPolicy* camera_info = nullptr;
  SizeMemory* sizes = nullptr;
  CalibrationStore* store = nullptr;
  /// Where ~save puts the calibration if the store has no file at all; may be null.
  CalibrationStore* fallback_store = nullptr;
  /// Hears how each saving ended, by itself or by ~save; may be empty.
  std::function<void(const CalibrationStore::Outcome&)> saved;
};

struct ControlOptions {
  Options pipeline;
  std::vector<double> initial_intrinsics;  ///< That ~reset begins with; empty: the default guess.
  std::string commit_service;              ///< Of the camera's driver.
  std::string report_file;                 ///< For ~dump_report.
  double autosave_interval_s = 30.0;       ///< At least, between two; 0: never.
  double commit_timeout_s = 5.0;
};

/// ~reset, ~reset_tracking, ~save, ~commit, ~set_camera_info, ~freeze, ~set_scale, ~dump_report,
/// and saving by itself. Served by a thread of their own: neither a slow disk nor a driver that
/// does not answer holds up images. Every answer says what was done, or why it could not be.
class ControlServices {
 public:
  ControlServices(const ros::NodeHandle& private_node, const ControlOptions& options,
                  const ControlTargets& targets);
  /// Ends the services, and saves what is new.
  ~ControlServices();

  /// Live: see ControlOptions.
  void setAutosaveInterval(double seconds);

 private:
  using Trigger = std_srvs::Trigger;

  bool reset(Trigger::Request& request, Trigger::Response& response);
  bool resetTracking(Trigger::Request& request, Trigger::Response& response);
  bool save(Trigger::Request& request, Trigger::Response& response);
  bool commit(Trigger::Request& request, Trigger::Response& response);
  bool dumpReport(Trigger::Request& request, Trigger::Response& response);
  bool freeze(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);
  bool setCameraInfo(sensor_msgs::SetCameraInfo::Request& request,
                     sensor_msgs::SetCameraInfo::Response& response);
  bool setScale(SetScale::Request& request, SetScale::Response& response);

  struct Present {
    CalibrationReport report;
    std::shared_ptr<const LearntState> state;
    std::int64_t dropped_images = 0;
  };
  std::optional<Present> present() const;
  /// What learning begins with; `problem` says what of the parameters is not used.
  Camera unlearnt(int width, int height, std::string* problem) const;
  std::string whyNotConverged(const std::optional<Present>& now,
                              const sensor_msgs::CameraInfo& info) const;
  void autosave(bool at_once);
  CalibrationStore::Outcome saveTo(CalibrationStore* store, const Present& now,
                                   const sensor_msgs::CameraInfo& info);

  ros::NodeHandle node_;
  const ControlOptions options_;
  const ControlTargets targets_;
  std::atomic<double> autosave_interval_s_;
  std::shared_ptr<const LearntState> saved_;
  ros::WallTime last_save_ = ros::WallTime::now();
  std::string last_problem_;
  ros::CallbackQueue queue_;
  std::vector<ros::ServiceServer> servers_;
  ros::WallTimer timer_;
  std::unique_ptr<ros::AsyncSpinner> spinner_;
};

}  // namespace camera_self_calibration
