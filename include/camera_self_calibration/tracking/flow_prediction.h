#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "camera_self_calibration/tracking/pyramid.h"

namespace camera_self_calibration {

/// Where the features of one image are in the next, to about a pixel: pyramidal Lucas-Kanade, and a
/// check back on the finest level. Between images of different exposure the first is taken as
/// bright as the second. Its errors do not matter beyond that, for registration follows.
class FlowPrediction {
 public:
  /// `predicted` holds a first guess for each point; on return the positions in `to`.
  void run(const ImagePyramid& from, const ImagePyramid& to, const std::vector<cv::Point2f>& points,
           std::vector<cv::Point2f>* predicted);

  /// Whether the i-th point of the last run was found, and leads back to where it came from.
  bool found(std::size_t i) const { return found_[i] != 0; }

 private:
  const std::vector<cv::Mat>& balanced(const ImagePyramid& from, const ImagePyramid& to);

  std::vector<cv::Mat> balanced_;
  std::vector<std::uint8_t> found_;
  std::vector<std::uint8_t> found_back_;
  std::vector<cv::Point2f> back_;
  std::vector<float> unused_error_;
};

}  // namespace camera_self_calibration
