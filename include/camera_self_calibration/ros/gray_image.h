#pragma once

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

/// Either a gray image or, in plain words, why there is none.
struct GrayImage {
  std::optional<ImageView> view;
  std::string error;  ///< Empty if there is a view.
};

/// Turns the messages of one camera into gray images of 8 bits. Not thread-safe.
class GrayConverter {
 public:
  /// mono8 without a copy (the view keeps the message alive); colour and Bayer of 8 and 16 bits,
  /// mono16, yuv422 and yuv422_yuy2 converted. Never throws on malformed messages.
  GrayImage convert(const sensor_msgs::ImageConstPtr& message);

  /// Decoded straight to gray; pictures of 16 bits as mono16.
  GrayImage convert(const sensor_msgs::CompressedImage& message);

 private:
  GrayImage convertMono16(const sensor_msgs::ImageConstPtr& message);
  GrayImage convertDeepColour(const sensor_msgs::ImageConstPtr& message,
                              const std::string& encoding);
  cv::Mat toEightBits(const cv::Mat& deep);

  // Significant bits of mono16 pixels, since cameras of 10 or 12 bits fill the low ones only. Grows
  // with the brightest pixel seen, so that the scale does not flicker.
  int significant_bits_ = 8;
};

}  // namespace camera_self_calibration
