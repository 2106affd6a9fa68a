#include "camera_self_calibration/ros/image_input.h"

#include <utility>

namespace camera_self_calibration {
namespace {

constexpr std::uint32_t kQueue = 10;

}  // namespace

ImageInput::ImageInput(const ros::NodeHandle& node, std::string topic, std::string transport,
                       Callback callback)
    : node_(node),
      topic_(std::move(topic)),
      transport_(std::move(transport)),
      callback_(std::move(callback)) {}

void ImageInput::subscribe() {
  if (transport_ != "compressed") {
    raw_ = node_.subscribe(topic_, kQueue, &ImageInput::onRaw, this);
  }
  if (transport_ != "raw") {
    compressed_ = node_.subscribe(topic_ + "/compressed", kQueue, &ImageInput::onCompressed, this);
  }
}

void ImageInput::shutdown() {
  raw_.shutdown();
  compressed_.shutdown();
}

void ImageInput::onRaw(const ros::MessageEvent<const sensor_msgs::Image>& event) {
  compressed_.shutdown();  // "auto": what comes first is taken.
  const sensor_msgs::ImageConstPtr& message = event.getConstMessage();
  callback_(
      {message->header, converter_.convert(message), message, nullptr, event.getPublisherName()});
}

void ImageInput::onCompressed(const ros::MessageEvent<const sensor_msgs::CompressedImage>& event) {
  raw_.shutdown();
  const sensor_msgs::CompressedImageConstPtr& message = event.getConstMessage();
  callback_(
      {message->header, converter_.convert(*message), nullptr, message, event.getPublisherName()});
}

}  // namespace camera_self_calibration
