#include "camera_self_calibration/tracking/usable_area.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace camera_self_calibration {

UsableArea::UsableArea(const std::optional<ImageView>& mask) {
  if (!mask) return;
  // OpenCV has no matrix over constant data; it is only read.
  const cv::Mat given(mask->height, mask->width, CV_8UC1, const_cast<std::uint8_t*>(mask->data),
                      static_cast<std::size_t>(mask->stride));
  mask_ = given != 0;
}

void UsableArea::setImageSize(int width, int height) {
  if (mask_.empty() || distance_.size() == cv::Size(width, height)) return;
  cv::Mat scaled;
  cv::resize(mask_, scaled, {width, height}, 0.0, 0.0, cv::INTER_NEAREST);
  cv::distanceTransform(scaled, distance_, cv::DIST_C, 3);
}

bool UsableArea::contains(double x, double y, int margin) const {
  if (distance_.empty()) return true;
  const int column = static_cast<int>(std::lround(x));
  const int row = static_cast<int>(std::lround(y));
  if (column < 0 || row < 0 || column >= distance_.cols || row >= distance_.rows) {
    return true;  // a mask says nothing of what lies beside the image
  }
  return distance_.at<float>(row, column) > static_cast<float>(margin);
}

}  // namespace camera_self_calibration
