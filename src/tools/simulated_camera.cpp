#include "camera_self_calibration/tools/simulated_camera.h"

#include <geometry_msgs/PoseStamped.h>
#include <ros/callback_queue.h>
#include <ros/init.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>
#include <std_msgs/Header.h>

#include <boost/make_shared.hpp>

#include "camera_self_calibration/ros/camera_info.h"
#include "camera_self_calibration/ros/messages.h"
#include "camera_self_calibration/ros/stamps.h"

namespace camera_self_calibration {
namespace {

sensor_msgs::ImagePtr toMessage(const SimulatedFrame& frame, const std_msgs::Header& header) {
  const auto message = boost::make_shared<sensor_msgs::Image>();
  message->header = header;
  message->encoding = sensor_msgs::image_encodings::MONO8;
  message->width = static_cast<std::uint32_t>(frame.image.cols);
  message->height = static_cast<std::uint32_t>(frame.image.rows);
  message->step = message->width;
  message->data.reserve(frame.image.total());
  for (int row = 0; row < frame.image.rows; ++row) {
    const std::uint8_t* pixels = frame.image.ptr<std::uint8_t>(row);
    message->data.insert(message->data.end(), pixels, pixels + frame.image.cols);
  }
  return message;
}

/// The parameters as they are, in a message for comparison.
Calibration trueCalibration(const Camera& camera) {
  CalibrationReport report;
  report.camera = camera;
  report.state = CalibrationState::kConverged;
  report.sentence = "the true values of the simulation";
  Calibration message = toCalibration(report, TrackingState::kTracking, report.sentence);
  message.sigma.assign(message.sigma.size(), 0.0);
  return message;
}

}  // namespace

SimulatedCamera::SimulatedCamera(const ros::NodeHandle& node, const SimulationOptions& options)
    : options_(options), sequence_(options.sequence), node_(node, options.name) {
  constexpr std::uint32_t kQueue = 10;
  image_ = node_.advertise<sensor_msgs::Image>("image_raw", kQueue);
  camera_info_ = node_.advertise<sensor_msgs::CameraInfo>("camera_info", kQueue);
  true_camera_info_ = node_.advertise<sensor_msgs::CameraInfo>("truth/camera_info", kQueue);
  true_calibration_ = node_.advertise<Calibration>("truth/calibration", 1, true);
  true_pose_ = node_.advertise<geometry_msgs::PoseStamped>("truth/pose", kQueue);
  finished_ = node_.advertise<std_msgs::Header>("truth/finished", 1, true);
  if (options_.publish_clock) clock_ = node_.advertise<rosgraph_msgs::Clock>("/clock", kQueue);
  if (!options_.wait_for.empty()) {
    status_ = node_.subscribe<TrackingStatus>(
        options_.wait_for, kQueue,
        [this](const TrackingStatus::ConstPtr& status) { processed_ = status->header.stamp; });
  }
}

void SimulatedCamera::publish(const SimulatedFrame& frame) {
  if (frame.stamp_ns == sequence_.stampNs(0)) publishTruth(frame);
  publishClock(frame.stamp_ns);
  publishFrame(frame);
  if (!options_.wait_for.empty()) waitUntilProcessed(toRosTime(frame.stamp_ns));
}

void SimulatedCamera::finish() { publishFinished(sequence_.stampNs(sequence_.size() - 1)); }

bool SimulatedCamera::waitForSubscribers() {
  if (options_.wait_for.empty()) return true;
  const auto subscribers = static_cast<std::uint32_t>(options_.image_subscribers);
  while (ros::ok() &&
         (image_.getNumSubscribers() < subscribers || status_.getNumPublishers() == 0)) {
    publishClock(sequence_.stampNs(0));
    ros::WallDuration(0.05).sleep();
  }
  return ros::ok();
}

void SimulatedCamera::publishTruth(const SimulatedFrame& frame) {
  Calibration message = trueCalibration(frame.camera);
  message.header.stamp = toRosTime(frame.stamp_ns);
  message.header.frame_id = options_.frame_id;
  true_calibration_.publish(message);
}

void SimulatedCamera::publishFrame(const SimulatedFrame& frame) {
  std_msgs::Header header;
  header.stamp = toRosTime(frame.stamp_ns);
  header.frame_id = options_.frame_id;
  sensor_msgs::CameraInfo uncalibrated =
      uncalibratedCameraInfo(frame.camera.width(), frame.camera.height());
  uncalibrated.header = header;
  camera_info_.publish(uncalibrated);
  if (std::optional<CameraInfoConversion> truth = toCameraInfo(frame.camera)) {
    truth->info.header = header;
    true_camera_info_.publish(truth->info);
  }
  image_.publish(toMessage(frame, header));
  geometry_msgs::PoseStamped pose;
  pose.header = header;
  pose.header.frame_id = options_.world_frame;
  pose.pose = toPose(frame.world_from_camera);
  true_pose_.publish(pose);
}

void SimulatedCamera::publishClock(std::int64_t stamp_ns) {
  if (!options_.publish_clock) return;
  rosgraph_msgs::Clock message;
  message.clock = toRosTime(stamp_ns);
  clock_.publish(message);
}

void SimulatedCamera::publishFinished(std::int64_t stamp_ns) {
  std_msgs::Header message;
  message.stamp = toRosTime(stamp_ns);
  message.frame_id = options_.frame_id;
  finished_.publish(message);
}

void SimulatedCamera::waitUntilProcessed(const ros::Time& stamp) {
  const ros::WallTime limit = ros::WallTime::now() + ros::WallDuration(options_.wait_limit_s);
  while (ros::ok() && processed_ < stamp && ros::WallTime::now() < limit) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
  }
}

void run(std::vector<std::unique_ptr<SimulatedCamera>>* cameras) {
  for (const auto& camera : *cameras) {
    if (!camera->waitForSubscribers()) return;
  }
  const SimulatedCamera& first = *cameras->front();
  const ros::WallDuration period(1.0 / first.rate());
  ros::WallTime due = ros::WallTime::now();
  for (int i = 0; i < first.size() && ros::ok(); ++i) {
    std::vector<SimulatedFrame> frames;
    for (const auto& camera : *cameras) frames.push_back(camera->frame(i));
    const ros::WallTime now = ros::WallTime::now();
    if (now < due) (due - now).sleep();
    // After a delay the cameras go on at their rate rather than catching up.
    due = std::max(due, now) + period;
    for (std::size_t c = 0; c < frames.size(); ++c) (*cameras)[c]->publish(frames[c]);
  }
  for (const auto& camera : *cameras) camera->finish();
}

}  // namespace camera_self_calibration
