#pragma once

#include <rosbag/bag.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <opencv2/imgcodecs.hpp>
#include <string>

#include "camera_self_calibration/ros/stamps.h"
#include "camera_self_calibration/simulation/simulated_sequence.h"

namespace camera_self_calibration {

/// A quickly rendered sequence of half the usual image size.
inline SequenceOptions smallSequence(MotionKind motion, double duration_s) {
  Intrinsics lens(5);
  lens << 158.0, 157.0, 162.0, 117.0, 0.9;
  SequenceOptions options;
  options.lens.camera = Camera(CameraModel::kFov, 320, 240, lens);
  options.motion.kind = motion;
  options.duration_s = duration_s;
  return options;
}

inline sensor_msgs::CompressedImage jpegOf(const SimulatedFrame& frame) {
  sensor_msgs::CompressedImage message;
  message.header.stamp = toRosTime(frame.stamp_ns);
  message.header.frame_id = "camera";
  message.format = "jpeg";
  cv::imencode(".jpg", frame.image, message.data, {cv::IMWRITE_JPEG_QUALITY, 98});
  return message;
}

inline void writeBag(const std::string& path, const std::string& topic,
                     const SequenceOptions& options) {
  const SimulatedSequence sequence(options);
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  for (int i = 0; i < sequence.size(); ++i) {
    const sensor_msgs::CompressedImage message = jpegOf(sequence.frame(i));
    bag.write(topic, message.header.stamp, message);
  }
}

}  // namespace camera_self_calibration
