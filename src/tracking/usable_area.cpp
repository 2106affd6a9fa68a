#include "camera_self_calibration/tracking/usable_area.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace camera_self_calibration {

UsableArea::UsableArea(const std::optional<ImageView>& mask, int margin) : margin_(margin) {
  if (!mask) return;
  // OpenCV has no matrix over constant data; it is only read.
  const cv::Mat given(mask->height, mask->width, CV_8UC1, const_cast<std::uint8_t*>(mask->data),
                      static_cast<std::size_t>(mask->stride));
  mask_ = given != 0;
}

void UsableArea::setImageSize(int width, int height) {
  if (mask_.empty() || usable_.size() == cv::Size(width, height)) return;
  cv::Mat scaled;
  cv::resize(mask_, scaled, {width, height}, 0.0, 0.0, cv::INTER_NEAREST);
  const cv::Size square(2 * margin_ + 1, 2 * margin_ + 1);
  cv::erode(scaled, usable_, cv::getStructuringElement(cv::MORPH_RECT, square));
}

bool UsableArea::contains(double x, double y) const {
  if (usable_.empty()) return true;
  const int column = static_cast<int>(std::lround(x));
  const int row = static_cast<int>(std::lround(y));
  if (column < 0 || row < 0 || column >= usable_.cols || row >= usable_.rows) return false;
  return usable_.at<std::uint8_t>(row, column) != 0;
}

}  // namespace camera_self_calibration
