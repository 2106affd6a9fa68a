#include "camera_self_calibration/ros/self_calibration_node.h"

#include <cv_bridge/cv_bridge.h>

#include <exception>

namespace camera_self_calibration {
namespace {

constexpr std::uint32_t kImageQueue = 10;

/// The start values of the parameters for images of this size.
std::optional<Camera> initialCamera(const NodeOptions& options, int width, int height) {
  const std::vector<double>& values = options.initial_intrinsics;
  if (values.empty()) return std::nullopt;
  return Camera(
      options.pipeline.model, width, height,
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
}

}  // namespace

SelfCalibrationNode::SelfCalibrationNode(const ros::NodeHandle& node,
                                         const ros::NodeHandle& private_node,
                                         const std::string& name)
    : node_(node), private_node_(private_node) {
  const NodeOptionsReading reading = readNodeOptions(private_node_);
  options_ = reading.options;
  camera_info_policy_ = std::make_unique<CameraInfoPolicy>(options_.min_publish_change_px);
  diagnostics_ =
      std::make_unique<Diagnostics>(node_, private_node_, name, camera_info_policy_.get());
  diagnostics_->setTopic(node_.resolveName("image"));
  diagnostics_timer_ = private_node_.createWallTimer(
      ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { diagnostics_->publish(); });
  if (!reading.problems.empty()) {
    stayIdle(reading.problems);
    return;
  }
  results_ = std::make_unique<ResultPublisher>(private_node_, options_);
  image_publisher_ =
      image_transport::ImageTransport(private_node_).advertise("image_raw", kImageQueue);
  camera_info_publisher_ =
      private_node_.advertise<sensor_msgs::CameraInfo>("camera_info", kImageQueue);
  subscribe();
}

SelfCalibrationNode::~SelfCalibrationNode() {
  raw_subscriber_.shutdown();
  compressed_subscriber_.shutdown();
  diagnostics_timer_.stop();
  calibrator_.reset();
}

void SelfCalibrationNode::stayIdle(const std::vector<std::string>& problems) {
  std::string text;
  for (const std::string& problem : problems) text += "\n  - " + problem;
  ROS_ERROR_STREAM(private_node_.getNamespace()
                   << ": idle, since the parameters cannot be used:" << text);
  diagnostics_->setProblems(problems);
}

void SelfCalibrationNode::subscribe() {
  const std::string topic = node_.resolveName("image");
  if (options_.image_transport != "compressed") {
    raw_subscriber_ = node_.subscribe(topic, kImageQueue, &SelfCalibrationNode::onImage, this);
  }
  if (options_.image_transport != "raw") {
    compressed_subscriber_ = node_.subscribe(topic + "/compressed", kImageQueue,
                                             &SelfCalibrationNode::onCompressed, this);
  }
}

void SelfCalibrationNode::onImage(const sensor_msgs::ImageConstPtr& message) {
  compressed_subscriber_.shutdown();  // "auto": what comes first is taken.
  const GrayImage gray = converter_.convert(message);
  if (gray.view) {
    image_publisher_.publish(message);
    publishCameraInfo(message->header, *gray.view);
  }
  take(gray, message->header);
}

void SelfCalibrationNode::onCompressed(const sensor_msgs::CompressedImageConstPtr& message) {
  raw_subscriber_.shutdown();
  const GrayImage gray = converter_.convert(*message);
  if (gray.view) {
    if (image_publisher_.getNumSubscribers() > 0) republish(*message);
    publishCameraInfo(message->header, *gray.view);
  }
  take(gray, message->header);
}

void SelfCalibrationNode::republish(const sensor_msgs::CompressedImage& message) {
  try {
    image_publisher_.publish(cv_bridge::toCvCopy(message)->toImageMsg());
  } catch (const std::exception& e) {
    warnThrottled(std::string("the image cannot be republished: ") + e.what());
  }
}

void SelfCalibrationNode::publishCameraInfo(const std_msgs::Header& header, const ImageView& view) {
  if (camera_info_publisher_.getNumSubscribers() == 0) return;
  camera_info_publisher_.publish(camera_info_policy_->infoFor(header, view.width, view.height));
}

void SelfCalibrationNode::take(const GrayImage& gray, const std_msgs::Header& header) {
  const InputVerdict verdict = monitor_.check(gray);
  diagnostics_->update(monitor_.counts());
  if (verdict != InputVerdict::kUse) warnThrottled(monitor_.counts().last_problem);
  if (verdict == InputVerdict::kReject || (!calibrator_ && !start())) return;
  results_->setImageFrame(header.frame_id);
  if (!calibrator_->process(*gray.view)) ++dropped_images_;
}

bool SelfCalibrationNode::start() {
  try {
    Options options = options_.pipeline;
    options.initial_camera = initialCamera(options_, monitor_.width(), monitor_.height());
    calibrator_ =
        std::make_unique<SelfCalibrator>(options, SelfCalibrator::Mode::kThreaded, callbacks());
    return true;
  } catch (const std::exception& e) {
    stayIdle({e.what()});
    raw_subscriber_.shutdown();
    compressed_subscriber_.shutdown();
    return false;
  }
}

Callbacks SelfCalibrationNode::callbacks() {
  Callbacks callbacks;
  callbacks.frame = [this](const FrameResult& result) {
    const std::int64_t dropped = dropped_images_;
    diagnostics_->update(result, dropped);
    results_->publish(result, dropped);
  };
  callbacks.calibration = [this](const CalibrationReport& report) {
    camera_info_policy_->update(report);
    diagnostics_->update(report);
    results_->publish(report);
  };
  callbacks.event = [this](const Event& event) {
    ROS_INFO_STREAM(private_node_.getNamespace()
                    << ": " << toString(event.type) << ": " << event.sentence);
    results_->publish(event);
  };
  return callbacks;
}

void SelfCalibrationNode::warnThrottled(const std::string& text) {
  const ros::WallTime now = ros::WallTime::now();
  if (!last_warning_.isZero() && now - last_warning_ < ros::WallDuration(5.0)) return;
  last_warning_ = now;
  ROS_WARN_STREAM(private_node_.getNamespace() << ": " << text);
}

}  // namespace camera_self_calibration
