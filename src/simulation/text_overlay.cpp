#include "camera_self_calibration/simulation/text_overlay.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "camera_self_calibration/base/formatted.h"

namespace camera_self_calibration {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kCapitalHeight = 21.0;  // of the font at scale 1 [px]
constexpr double kWhite = 255.0;

}  // namespace

void writeOverlay(double time_s, cv::Mat* image) {
  const double height = image->rows / 20.0;
  const double scale = height / kCapitalHeight;
  const int thickness = image->rows < 400 ? 1 : 2;
  const int margin = static_cast<int>(std::lround(0.7 * height));
  const auto tenths = static_cast<int>(10.0 * time_s);
  const std::string time =
      formatted("2024-03-01 10:%02d:%02d.%d", tenths / 600 % 60, tenths / 10 % 60, tenths % 10);
  const std::string name = "CAM 2 FRONT";
  const cv::Size extent = cv::getTextSize(name, kFont, scale, thickness, nullptr);
  const cv::Point upper_left(margin, margin + static_cast<int>(height));
  const cv::Point lower_right(image->cols - margin - extent.width, image->rows - margin);
  cv::putText(*image, time, upper_left, kFont, scale, kWhite, thickness, cv::LINE_AA);
  cv::putText(*image, name, lower_right, kFont, scale, kWhite, thickness, cv::LINE_AA);
}

}  // namespace camera_self_calibration
