#pragma once

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

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
  /// mono8 without a copy (the view keeps the message alive); bgr8, rgb8, bgra8, rgba8, Bayer,
  /// yuv422 and mono16 converted. Never throws on malformed messages.
  GrayImage convert(const sensor_msgs::ImageConstPtr& message);

  /// Decoded straight to gray.
  GrayImage convert(const sensor_msgs::CompressedImage& message) const;

 private:
  GrayImage convertMono16(const sensor_msgs::ImageConstPtr& message);

  // Significant bits of mono16 pixels, since cameras of 10 or 12 bits fill the low ones only. Grows
  // with the brightest pixel seen, so that the scale does not flicker.
  int significant_bits_ = 8;
};

}  // namespace camera_self_calibration
