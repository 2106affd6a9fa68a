#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

/// Window of the flow prediction [px]; the levels that it works on carry a border of this width.
constexpr int kFlowWindow = 15;

/// An image at halved resolutions. Pixel p of level 0 lies at p / 2^level. The image is copied, so
/// that it need not live on; buffers are kept from one build to the next of the same size.
class ImagePyramid {
 public:
  /// Whether the view describes an image at all.
  static bool usable(const ImageView& image);

  void build(const ImageView& image);
  void clear();

  bool empty() const { return full_.empty(); }
  cv::Size size() const { return full_.size(); }
  int levels() const { return flowLevel() + static_cast<int>(flow_mats_.size() / 2); }
  const cv::Mat& level(int l) const {
    return l < flowLevel() ? full_ : flow_mats_[2 * static_cast<std::size_t>(l - flowLevel())];
  }

  /// The finest level that the flow prediction uses: 1, or 0 of an image that has no other.
  int flowLevel() const { return flow_level_; }
  /// From flowLevel() on: levels, and their derivatives, in the order that
  /// cv::calcOpticalFlowPyrLK expects.
  const std::vector<cv::Mat>& flowMats() const { return flow_mats_; }

 private:
  cv::Mat full_;
  cv::Mat half_;
  int flow_level_ = 0;
  std::vector<cv::Mat> flow_mats_;
};

}  // namespace camera_self_calibration
