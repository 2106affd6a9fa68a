#include "camera_self_calibration/simulation/canvas.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace camera_self_calibration {
namespace {

constexpr int kOversampling = 2;
constexpr int kShift = 4;  // fractional bits of drawing coordinates

cv::Scalar ink(double gray) { return cv::Scalar(std::clamp(gray, 4.0, 251.0)); }

}  // namespace

Canvas::Canvas(double width_m, double height_m, double texels_per_metre, double gray)
    : width_m_(width_m), height_m_(height_m), scale_(kOversampling * texels_per_metre) {
  const int columns = std::max(1, static_cast<int>(std::lround(width_m * texels_per_metre)));
  const int rows = std::max(1, static_cast<int>(std::lround(height_m * texels_per_metre)));
  image_ = cv::Mat(kOversampling * rows, kOversampling * columns, CV_8UC1, ink(gray));
}

// Drawing pixel i covers [i, i + 1], OpenCV's coordinates count from pixel centres.
cv::Point Canvas::point(double x, double y) const {
  const double fraction = 1 << kShift;
  return {static_cast<int>(std::lround((x * scale_ - 0.5) * fraction)),
          static_cast<int>(std::lround((y * scale_ - 0.5) * fraction))};
}

void Canvas::rectangle(double left, double top, double right, double bottom, double gray) {
  polygon({{left, top}, {right, top}, {right, bottom}, {left, bottom}}, gray);
}

void Canvas::frame(double left, double top, double right, double bottom, double line_width,
                   double gray) {
  rectangle(left, top, right, top + line_width, gray);
  rectangle(left, bottom - line_width, right, bottom, gray);
  rectangle(left, top, left + line_width, bottom, gray);
  rectangle(right - line_width, top, right, bottom, gray);
}

void Canvas::polygon(const std::vector<cv::Point2d>& points, double gray) {
  std::vector<cv::Point> corners;
  corners.reserve(points.size());
  for (const cv::Point2d& p : points) corners.push_back(point(p.x, p.y));
  cv::fillConvexPoly(image_, corners, ink(gray), cv::LINE_AA, kShift);
}

void Canvas::circle(double x, double y, double radius, double gray) {
  const int size = static_cast<int>(std::lround(radius * scale_ * (1 << kShift)));
  cv::circle(image_, point(x, y), size, ink(gray), cv::FILLED, cv::LINE_AA, kShift);
}

void Canvas::line(double x0, double y0, double x1, double y1, double line_width, double gray) {
  const int thickness = std::max(1, static_cast<int>(std::lround(line_width * scale_)));
  cv::line(image_, point(x0, y0), point(x1, y1), ink(gray), thickness, cv::LINE_AA, kShift);
}

void Canvas::text(const std::string& letters, double x, double y, double size, double gray,
                  bool vertical) {
  const double capital_height = 21.0;  // of the font at scale 1 [px]
  const double font_scale = size * scale_ / capital_height;
  const int thickness = std::max(1, static_cast<int>(std::lround(0.14 * size * scale_)));
  const auto x_px = static_cast<int>(x * scale_);
  const auto y_px = static_cast<int>(y * scale_);
  if (!vertical) {
    cv::putText(image_, letters, {x_px, y_px}, cv::FONT_HERSHEY_SIMPLEX, font_scale, ink(gray),
                thickness, cv::LINE_AA);
    return;
  }
  // Written on a strip that is turned back into its place.
  const cv::Size extent =
      cv::getTextSize(letters, cv::FONT_HERSHEY_SIMPLEX, font_scale, thickness, nullptr);
  const cv::Rect place = cv::Rect(x_px - extent.height / 2, y_px, 2 * extent.height, extent.width) &
                         cv::Rect(cv::Point(), image_.size());
  if (place.empty()) return;
  cv::Mat turned;
  cv::rotate(image_(place), turned, cv::ROTATE_90_COUNTERCLOCKWISE);
  cv::putText(turned, letters, {0, turned.rows - extent.height / 2}, cv::FONT_HERSHEY_SIMPLEX,
              font_scale, ink(gray), thickness, cv::LINE_AA);
  cv::rotate(turned, turned, cv::ROTATE_90_CLOCKWISE);
  turned.copyTo(image_(place));
}

void Canvas::speckles(double per_square_metre, double contrast, Random* random) {
  const int count = static_cast<int>(per_square_metre * width_m_ * height_m_);
  for (int i = 0; i < count; ++i) {
    const double x = random->uniform(0.0, width_m_);
    const double y = random->uniform(0.0, height_m_);
    const double size = 0.004 * std::pow(7.5, random->uniform());
    const double turn = random->uniform(0.0, 2.0 * M_PI);
    const double aspect = random->uniform(0.3, 1.0);
    const int column = std::min(image_.cols - 1, static_cast<int>(x * scale_));
    const int row = std::min(image_.rows - 1, static_cast<int>(y * scale_));
    const double gray = image_.at<std::uint8_t>(row, column) +
                        contrast * random->uniform(0.4, 1.0) * (random->chance(0.5) ? 1.0 : -1.0);
    std::vector<cv::Point2d> corners;
    const int sides = random->integer(3, 5);
    for (int k = 0; k < sides; ++k) {
      const double angle = 2.0 * M_PI * k / sides;
      const double a = 0.5 * size * std::cos(angle);
      const double b = 0.5 * size * aspect * std::sin(angle);
      corners.emplace_back(x + a * std::cos(turn) - b * std::sin(turn),
                           y + a * std::sin(turn) + b * std::cos(turn));
    }
    polygon(corners, gray);
  }
}

cv::Mat Canvas::finish(double cloud_contrast, Random* random) const {
  cv::Mat small;
  cv::resize(image_, small, image_.size() / kOversampling, 0.0, 0.0, cv::INTER_AREA);
  cv::Mat sum;
  small.convertTo(sum, CV_32F);
  double contrast = cloud_contrast;
  for (const double wave_m : {1.6, 0.5, 0.15}) {
    cv::Mat coarse(static_cast<int>(height_m_ / wave_m) + 3,
                   static_cast<int>(width_m_ / wave_m) + 3, CV_32F);
    for (int y = 0; y < coarse.rows; ++y) {
      for (int x = 0; x < coarse.cols; ++x) {
        coarse.at<float>(y, x) = static_cast<float>(contrast * random->normal());
      }
    }
    cv::Mat fine;
    cv::resize(coarse, fine, small.size(), 0.0, 0.0, cv::INTER_CUBIC);
    sum += fine;
    contrast *= 0.5;
  }
  cv::Mat finished;
  sum.convertTo(finished, CV_8U);
  return finished;
}

std::string randomLetters(int count, Random* random) {
  std::string letters;
  for (int i = 0; i < count; ++i) {
    letters += "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"[random->integer(0, 35)];
  }
  return letters;
}

}  // namespace camera_self_calibration
