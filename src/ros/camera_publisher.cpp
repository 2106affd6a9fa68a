#include "camera_self_calibration/ros/camera_publisher.h"

#include <cv_bridge/cv_bridge.h>

#include <exception>
#include <utility>

namespace camera_self_calibration {
namespace {

constexpr std::uint32_t kQueue = 10;

}  // namespace

CameraPublisher::CameraPublisher(const ros::NodeHandle& node, InfoFor info_for)
    : info_for_(std::move(info_for)) {
  ros::NodeHandle own(node);
  image_ = image_transport::ImageTransport(own).advertise("image_raw", kQueue);
  camera_info_ = own.advertise<sensor_msgs::CameraInfo>("camera_info", kQueue);
}

std::string CameraPublisher::publish(const InputImage& image) {
  if (!image.gray.view) return {};
  std::string problem;
  if (image_.getNumSubscribers() > 0) {
    if (image.raw) {
      image_.publish(image.raw);
    } else {
      problem = publishDecoded(*image.compressed);
    }
  }
  if (camera_info_.getNumSubscribers() > 0) {
    const ImageView& view = *image.gray.view;
    camera_info_.publish(info_for_(image.header, view.width, view.height));
  }
  return problem;
}

std::string CameraPublisher::publishDecoded(const sensor_msgs::CompressedImage& message) {
  try {
    image_.publish(cv_bridge::toCvCopy(message)->toImageMsg());
    return {};
  } catch (const std::exception& e) {
    return std::string("the image cannot be republished: ") + e.what();
  }
}

}  // namespace camera_self_calibration
