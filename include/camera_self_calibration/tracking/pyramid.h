#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

/// An image at halved resolutions. Pixel p of level 0 lies at p / 2^level. The image is copied, so
/// that it need not live on; buffers are kept from one build to the next of the same size.
class ImagePyramid {
 public:
  /// Each level goes on beyond its edges, mirrored, by so many pixels.
  static constexpr int kBorder = 16;

  /// Whether the view describes an image at all.
  static bool usable(const ImageView& image);

  void build(const ImageView& image);
  void clear();

  bool empty() const { return mats_.empty(); }
  cv::Size size() const { return empty() ? cv::Size() : mats_[0].size(); }
  int levels() const { return static_cast<int>(mats_.size()); }
  const cv::Mat& level(int l) const { return mats_[static_cast<std::size_t>(l)]; }

 private:
  std::vector<cv::Mat> mats_;
};

}  // namespace camera_self_calibration
