#pragma once

#include <opencv2/core.hpp>

namespace camera_self_calibration {

/// A camera's automatic exposure: the gain follows the mean gray value of the images, by a lag of
/// some of them, so that it is wrong after each turn, and what is much brighter than the mean is
/// white.
class AutoExposure {
 public:
  /// Of the next image: a factor on the light.
  double gain() const { return gain_; }

  /// Takes notice of an image that was taken with that gain (CV_8UC1).
  void see(const cv::Mat& image);

 private:
  double gain_ = 1.0;
};

}  // namespace camera_self_calibration
