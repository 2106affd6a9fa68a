#pragma once

#include <ros/message_event.h>
#include <ros/node_handle.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <functional>
#include <string>

#include "camera_self_calibration/ros/gray_image.h"

namespace camera_self_calibration {

/// An image as it came and as the pipeline takes it.
struct InputImage {
  std_msgs::Header header;
  GrayImage gray;
  sensor_msgs::ImageConstPtr raw;                   ///< Null if it came compressed.
  sensor_msgs::CompressedImageConstPtr compressed;  ///< Null if it came raw.
  std::string publisher;                            ///< The node that it comes from.
};

/// Subscribes to the images of one camera, raw or compressed, and turns them gray.
class ImageInput {
 public:
  using Callback = std::function<void(const InputImage&)>;

  /// `topic` is resolved; compressed images are expected on `topic`/compressed. `transport`: raw,
  /// compressed, or auto, which takes whichever brings the first image. No callback before
  /// subscribe().
  ImageInput(const ros::NodeHandle& node, std::string topic, std::string transport,
             Callback callback);

  void subscribe();
  void shutdown();

  const std::string& topic() const { return topic_; }

 private:
  void onRaw(const ros::MessageEvent<const sensor_msgs::Image>& event);
  void onCompressed(const ros::MessageEvent<const sensor_msgs::CompressedImage>& event);

  ros::NodeHandle node_;
  const std::string topic_;
  const std::string transport_;
  const Callback callback_;
  GrayConverter converter_;
  ros::Subscriber raw_;
  ros::Subscriber compressed_;
};

}  // namespace camera_self_calibration
