#pragma once

#include <ros/node_handle.h>

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "camera_self_calibration/ros/calibration_keeper.h"
#include "camera_self_calibration/ros/calibration_session.h"
#include "camera_self_calibration/ros/camera_info_policy.h"
#include "camera_self_calibration/ros/camera_publisher.h"
#include "camera_self_calibration/ros/diagnostics.h"
#include "camera_self_calibration/ros/factory_calibration.h"
#include "camera_self_calibration/ros/image_input.h"
#include "camera_self_calibration/ros/input_monitor.h"
#include "camera_self_calibration/ros/live_parameters.h"
#include "camera_self_calibration/ros/node_log.h"
#include "camera_self_calibration/ros/node_options.h"
#include "camera_self_calibration/ros/publisher_watch.h"
#include "camera_self_calibration/ros/result_publisher.h"
#include "camera_self_calibration/ros/size_memory.h"
#include "camera_self_calibration/ros/start_camera.h"
#include "camera_self_calibration/ros/visualizer.h"

namespace camera_self_calibration {

/// The interface of a SelfCalibrator to ROS, the same in the nodelet and the standalone node.
/// Topics and parameters are listed in doc/live.md. With wrong parameters it stays idle and says
/// so, in the log and on /diagnostics. All callbacks are expected on one thread at a time.
class SelfCalibrationNode {
 public:
  /// Returns at once and does not throw. `name` stands in /diagnostics.
  SelfCalibrationNode(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                      const std::string& name);
  ~SelfCalibrationNode();

 private:
  void stayIdle(const std::vector<std::string>& problems);
  void onImage(const InputImage& image);
  InputVerdict check(const InputImage& image);
  bool ready();
  void change(const SelfCalibrationConfig& config);
  void beginAnew(const std::string& what, const ros::Time& stamp);
  bool begin(const std::optional<Camera>& camera);
  void raise(const Event& event);
  Callbacks callbacks();

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  NodeLog log_;
  NodeOptions options_;
  PublisherWatch publisher_watch_;
  InputMonitor monitor_;

  // Used by the calibrator's threads, so they outlive it.
  std::atomic<std::int64_t> dropped_images_{0};
  std::unique_ptr<CameraInfoPolicy> camera_info_policy_;
  std::unique_ptr<FactoryCalibration> factory_;  // Null with camera_info_input: off.
  std::unique_ptr<StartCamera> start_camera_;
  std::unique_ptr<SizeMemory> size_memory_;
  std::unique_ptr<Diagnostics> diagnostics_;
  std::unique_ptr<ResultPublisher> results_;
  std::unique_ptr<CameraPublisher> camera_publisher_;
  std::unique_ptr<Visualizer> visualizer_;
  std::unique_ptr<CalibrationSession> session_;
  std::unique_ptr<CalibrationKeeper> keeper_;
  std::unique_ptr<LiveParameters> live_parameters_;

  ros::WallTimer diagnostics_timer_;
  std::unique_ptr<ImageInput> input_;
};

}  // namespace camera_self_calibration
