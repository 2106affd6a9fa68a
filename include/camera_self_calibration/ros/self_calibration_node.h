#pragma once

#include <image_transport/image_transport.h>
#include <ros/node_handle.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/ros/camera_info_policy.h"
#include "camera_self_calibration/ros/diagnostics.h"
#include "camera_self_calibration/ros/input_monitor.h"
#include "camera_self_calibration/ros/node_options.h"
#include "camera_self_calibration/ros/result_publisher.h"

namespace camera_self_calibration {

/// The interface of a SelfCalibrator to ROS, the same in the nodelet and the standalone node.
/// Topics and parameters are listed in README.md. With wrong parameters it stays idle and says so,
/// in the log and on /diagnostics. All callbacks are expected on one thread at a time.
class SelfCalibrationNode {
 public:
  /// Returns at once and does not throw. `name` stands in /diagnostics.
  SelfCalibrationNode(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                      const std::string& name);
  ~SelfCalibrationNode();

 private:
  void stayIdle(const std::vector<std::string>& problems);
  void subscribe();
  void onImage(const sensor_msgs::ImageConstPtr& message);
  void onCompressed(const sensor_msgs::CompressedImageConstPtr& message);
  void republish(const sensor_msgs::CompressedImage& message);
  void publishCameraInfo(const std_msgs::Header& header, const ImageView& view);
  void take(const GrayImage& gray, const std_msgs::Header& header);
  bool start();
  Callbacks callbacks();
  void warnThrottled(const std::string& text);

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  NodeOptions options_;
  GrayConverter converter_;
  InputMonitor monitor_;
  ros::WallTime last_warning_;

  // Used by the calibrator's threads, so they outlive it.
  std::atomic<std::int64_t> dropped_images_{0};
  std::unique_ptr<CameraInfoPolicy> camera_info_policy_;
  std::unique_ptr<Diagnostics> diagnostics_;
  std::unique_ptr<ResultPublisher> results_;
  image_transport::Publisher image_publisher_;
  ros::Publisher camera_info_publisher_;
  std::unique_ptr<SelfCalibrator> calibrator_;

  ros::WallTimer diagnostics_timer_;
  ros::Subscriber raw_subscriber_;
  ros::Subscriber compressed_subscriber_;
};

}  // namespace camera_self_calibration
