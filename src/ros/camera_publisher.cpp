#include "camera_self_calibration/ros/camera_publisher.h"

#include <cv_bridge/cv_bridge.h>

#include <exception>

namespace camera_self_calibration {
namespace {

constexpr std::uint32_t kQueue = 10;

}  // namespace

CameraPublisher::CameraPublisher(const ros::NodeHandle& private_node,
                                 const CameraInfoPolicy* camera_info)
    : policy_(camera_info) {
  ros::NodeHandle node(private_node);
  image_ = image_transport::ImageTransport(node).advertise("image_raw", kQueue);
  camera_info_ = node.advertise<sensor_msgs::CameraInfo>("camera_info", kQueue);
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
    camera_info_.publish(policy_->infoFor(image.header, view.width, view.height));
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
