#include "camera_self_calibration/ros/result_publisher.h"

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>

#include "camera_self_calibration/ros/messages.h"
#include "camera_self_calibration/ros/stamps.h"

namespace camera_self_calibration {
namespace {

std_msgs::Header headerOf(std::int64_t stamp_ns, const std::string& frame) {
  std_msgs::Header header;
  header.stamp = toRosTime(stamp_ns);
  header.frame_id = frame;
  return header;
}

}  // namespace

ResultPublisher::ResultPublisher(const ros::NodeHandle& private_node, const NodeOptions& options)
    : world_frame_(withoutSlash(options.world_frame)),
      child_frame_(options.child_frame),
      publish_tf_(options.publish_tf),
      invert_tf_(options.invert_tf),
      trail_(static_cast<std::size_t>(options.path_poses)) {
  ros::NodeHandle node(private_node);
  constexpr std::uint32_t kFrames = 10;
  pose_ = node.advertise<geometry_msgs::PoseWithCovarianceStamped>("pose", kFrames);
  odometry_ = node.advertise<nav_msgs::Odometry>("odometry", kFrames);
  path_ = node.advertise<nav_msgs::Path>("path", 1, true);
  tracking_status_ = node.advertise<TrackingStatus>("tracking_status", kFrames);
  calibration_ = node.advertise<Calibration>("calibration", kFrames, true);
  queue_ = node.advertise<Queue>("queue", kFrames, true);
  event_ = node.advertise<CalibrationEvent>("event", kFrames);
}

void ResultPublisher::setImageFrame(const std::string& frame) {
  const std::lock_guard<std::mutex> lock(mutex_);
  image_frame_ = frame;
}

std::string ResultPublisher::imageFrame() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return image_frame_;
}

FrameNames ResultPublisher::frameNames() const {
  return {world_frame_, child_frame_, imageFrame()};
}

void ResultPublisher::publish(const FrameResult& result, std::int64_t dropped_images) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    tracking_state_ = result.state;
    tracking_sentence_ = result.sentence;
  }
  if (result.moved) trail_.follow(*result.moved);
  if (result.state == TrackingState::kTracking) {
    if (publish_tf_) publishTransform(result);
    publishPose(result);
    publishOdometry(result);
    publishPath(result);
    last_tracked_ = result;
  }
  // Last, so that who waits for it knows that all of the image's results are out.
  TrackingStatus status = toTrackingStatus(result, dropped_images);
  status.header = headerOf(result.stamp_ns, imageFrame());
  tracking_status_.publish(status);
}

void ResultPublisher::publishPose(const FrameResult& result) {
  if (pose_.getNumSubscribers() == 0) return;
  geometry_msgs::PoseWithCovarianceStamped message;
  message.header = headerOf(result.stamp_ns, world_frame_);
  message.pose = toPoseWithCovariance(result);
  pose_.publish(message);
}

void ResultPublisher::publishOdometry(const FrameResult& result) {
  const bool continues = last_tracked_ && last_tracked_->map_id == result.map_id &&
                         last_tracked_->stamp_ns < result.stamp_ns;
  if (!continues || odometry_.getNumSubscribers() == 0) return;
  nav_msgs::Odometry message;
  message.header = headerOf(result.stamp_ns, world_frame_);
  message.child_frame_id = frameNames().camera();
  message.pose = toPoseWithCovariance(result);
  message.twist = toTwist(*last_tracked_, result);
  odometry_.publish(message);
}

void ResultPublisher::publishPath(const FrameResult& result) {
  // Keyframes suffice for a picture of the trajectory and keep the rate of a long path low.
  if (!result.is_keyframe) return;
  const bool taken = trail_.add({result.stamp_ns, result.world_from_camera}, result.map_id);
  if (!taken || path_.getNumSubscribers() == 0) return;
  nav_msgs::Path message;
  message.header = headerOf(result.stamp_ns, world_frame_);
  message.poses.reserve(trail_.poses().size());
  for (const Trail::Pose& pose : trail_.poses()) {
    geometry_msgs::PoseStamped stamped;
    stamped.header = headerOf(pose.stamp_ns, world_frame_);
    stamped.pose = toPose(pose.world_from_camera);
    message.poses.push_back(stamped);
  }
  path_.publish(message);
}

void ResultPublisher::publishTransform(const FrameResult& result) {
  const FrameNames frames = frameNames();
  if (!frames.problem().empty()) return;
  geometry_msgs::TransformStamped message;
  message.header = headerOf(result.stamp_ns, invert_tf_ ? frames.camera() : world_frame_);
  message.child_frame_id = invert_tf_ ? world_frame_ : frames.camera();
  message.transform =
      toTransform(invert_tf_ ? result.world_from_camera.inverse() : result.world_from_camera);
  broadcaster_.sendTransform(message);
}

void ResultPublisher::publish(const CalibrationReport& report) {
  TrackingState tracking_state = TrackingState::kInitializing;
  std::string tracking_sentence;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    epoch_ = report.epoch;
    tracking_state = tracking_state_;
    tracking_sentence = tracking_sentence_;
  }
  const std_msgs::Header header = headerOf(report.stamp_ns, imageFrame());
  Calibration calibration = toCalibration(report, tracking_state, tracking_sentence);
  calibration.header = header;
  calibration_.publish(calibration);
  Queue queue = toQueue(report.queue);
  queue.header = header;
  queue_.publish(queue);
}

void ResultPublisher::publish(const Event& event) {
  std::uint64_t epoch = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    epoch = epoch_;
  }
  CalibrationEvent message = toCalibrationEvent(event, epoch);
  message.header = headerOf(event.stamp_ns, imageFrame());
  event_.publish(message);
}

}  // namespace camera_self_calibration
