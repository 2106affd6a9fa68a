#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

/// Window of the flow prediction [px]; the pyramid's levels carry a border of this width. OpenCV
/// takes eight pixels of a row at a time, and those left over one by one.
constexpr int kFlowWindow = 16;

/// An image at halved resolutions, with the derivatives that the flow prediction and the corner
/// detection share. Pixel p of level 0 lies at p / 2^level. The image is copied, so that it need
/// not live on; buffers are kept from one build to the next of the same size.
class ImagePyramid {
 public:
  /// Whether the view describes an image at all.
  static bool usable(const ImageView& image);

  void build(const ImageView& image);
  void clear();

  bool empty() const { return mats_.empty(); }
  cv::Size size() const { return empty() ? cv::Size() : mats_[0].size(); }
  int levels() const { return static_cast<int>(mats_.size() / 2); }
  const cv::Mat& level(int l) const { return mats_[2 * static_cast<std::size_t>(l)]; }
  /// Scharr derivatives (16 bit, x and y interleaved, 32 times the gradient per pixel).
  const cv::Mat& derivatives(int l) const { return mats_[2 * static_cast<std::size_t>(l) + 1]; }
  /// Levels and derivatives in the order that cv::calcOpticalFlowPyrLK expects.
  const std::vector<cv::Mat>& mats() const { return mats_; }

 private:
  std::vector<cv::Mat> mats_;
};

}  // namespace camera_self_calibration
