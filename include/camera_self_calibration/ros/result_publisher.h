#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <tf2_ros/transform_broadcaster.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <string>

#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/ros/frame_names.h"
#include "camera_self_calibration/ros/node_options.h"
#include "camera_self_calibration/ros/trail.h"

namespace camera_self_calibration {

/// Publishes what the pipeline finds, with the stamps of the images. Poses go out while TRACKING.
/// publish() of frames, reports and events may be called from different threads.
class ResultPublisher {
 public:
  ResultPublisher(const ros::NodeHandle& private_node, const NodeOptions& options);

  /// The frame_id of the images.
  void setImageFrame(const std::string& frame);

  /// Whether transforms go out from now on.
  void setPublishTf(bool publish) { publish_tf_ = publish; }
  /// What hinders the transform, in words; empty if nothing does.
  std::string frameProblem() const { return frameNames().problem(); }

  void publish(const FrameResult& result, std::int64_t dropped_images);
  void publish(const CalibrationReport& report);
  void publish(const Event& event);

 private:
  std::string imageFrame() const;
  FrameNames frameNames() const;
  void publishPose(const FrameResult& result);
  void publishOdometry(const FrameResult& result);
  void publishPath(const FrameResult& result);
  void publishTransform(const FrameResult& result);

  const std::string world_frame_;
  const std::string child_frame_;
  std::atomic<bool> publish_tf_;
  const bool invert_tf_;
  ros::Publisher pose_;
  ros::Publisher odometry_;
  ros::Publisher path_;
  ros::Publisher tracking_status_;
  ros::Publisher calibration_;
  ros::Publisher queue_;
  ros::Publisher event_;
  tf2_ros::TransformBroadcaster broadcaster_;

  // Only used by the thread that publishes frames.
  Trail trail_;
  std::optional<FrameResult> last_tracked_;

  // Exchanged between the threads.
  mutable std::mutex mutex_;
  std::string image_frame_;
  TrackingState tracking_state_ = TrackingState::kInitializing;
  std::string tracking_sentence_;
  std::uint64_t epoch_ = 0;
};

}  // namespace camera_self_calibration
