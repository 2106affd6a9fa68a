#include "camera_self_calibration/plotting/sheet.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace camera_self_calibration {
namespace {

constexpr int kScale = 2;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
// Height of capital letters of the font at scale 1 [px].
constexpr double kCapHeight = 21.0;
// OpenCV's fixed-point coordinates: 1/16 px.
constexpr int kShift = 4;
constexpr double kFixed = 16.0;
// Coordinates beyond this overflow OpenCV's fixed-point numbers.
constexpr double kFar = 20000.0;

const std::string kPlusMinus = "\u00b1";

cv::Point fixed(const cv::Point2d& point, const cv::Point& offset = {}) {
  const auto one = [](double value, int shift) {
    return static_cast<int>(
        std::lround((std::clamp(value * kScale, -kFar, kFar) - shift) * kFixed));
  };
  return {one(point.x, offset.x), one(point.y, offset.y)};
}

std::vector<cv::Point> fixed(const std::vector<cv::Point2d>& points, const cv::Point& offset) {
  std::vector<cv::Point> all;
  all.reserve(points.size());
  for (const cv::Point2d& point : points) all.push_back(fixed(point, offset));
  return all;
}

int thickness(double width) { return std::max(1, static_cast<int>(std::lround(width * kScale))); }

cv::Rect scaled(const cv::Rect2d& area) {
  const cv::Point low(static_cast<int>(std::lround(area.x * kScale)),
                      static_cast<int>(std::lround(area.y * kScale)));
  const cv::Point high(static_cast<int>(std::lround((area.x + area.width) * kScale)),
                       static_cast<int>(std::lround((area.y + area.height) * kScale)));
  return {low, high};
}

/// The font has no plus-minus sign: a plus, underlined.
std::string withSigns(std::string text) {
  for (std::size_t at = text.find(kPlusMinus); at != std::string::npos;
       at = text.find(kPlusMinus, at)) {
    text.replace(at, kPlusMinus.size(), "+");
  }
  return text;
}

double letterScale(double size) { return size * kScale / kCapHeight; }
int letterThickness(double size, bool bold) {
  return std::max(1, static_cast<int>(std::lround(size * kScale / (bold ? 7.0 : 12.0))));
}

int largeWidth(const std::string& text, double size, bool bold) {
  int baseline = 0;
  return cv::getTextSize(text, kFont, letterScale(size), letterThickness(size, bold), &baseline)
      .width;
}

}  // namespace

Sheet::Sheet(int width, int height, const Colour& background)
    : large_(height * kScale, width * kScale, CV_8UC3, background) {}

cv::Mat Sheet::part(const cv::Rect2d& area, cv::Point* offset) {
  const cv::Rect inside = scaled(area) & cv::Rect(0, 0, large_.cols, large_.rows);
  *offset = inside.tl();
  return large_(inside);
}

void Sheet::fill(const cv::Rect2d& area, const Colour& colour) {
  cv::rectangle(large_, scaled(area), colour, cv::FILLED);
}

void Sheet::outline(const cv::Rect2d& area, const Colour& colour) {
  cv::rectangle(large_, scaled(area), colour, 1);
}

void Sheet::line(const cv::Point2d& from, const cv::Point2d& to, const Colour& colour,
                 double width) {
  cv::line(large_, fixed(from), fixed(to), colour, thickness(width), cv::LINE_AA, kShift);
}

void Sheet::dashes(const cv::Point2d& from, const cv::Point2d& to, const Colour& colour,
                   double width) {
  constexpr double kDash = 5.0;
  const double length = cv::norm(to - from);
  for (double at = 0.0; at < length; at += 2.0 * kDash) {
    const double end = std::min(length, at + kDash);
    line(from + (to - from) * (at / length), from + (to - from) * (end / length), colour, width);
  }
}

void Sheet::disc(const cv::Point2d& centre, double radius, const Colour& colour) {
  cv::circle(large_, fixed(centre), static_cast<int>(radius * kScale * kFixed), colour, cv::FILLED,
             cv::LINE_AA, kShift);
}

void Sheet::curve(const std::vector<cv::Point2d>& points, const Colour& colour, double width,
                  const cv::Rect2d& area) {
  cv::Point offset;
  cv::Mat inside = part(area, &offset);
  if (inside.empty() || points.empty()) return;
  cv::polylines(inside, fixed(points, offset), false, colour, thickness(width), cv::LINE_AA,
                kShift);
}

void Sheet::polygon(const std::vector<cv::Point2d>& points, const Colour& colour,
                    const cv::Rect2d& area) {
  cv::Point offset;
  cv::Mat inside = part(area, &offset);
  if (inside.empty() || points.size() < 3) return;
  const std::vector<std::vector<cv::Point>> polygons = {fixed(points, offset)};
  cv::fillPoly(inside, polygons, colour, cv::LINE_AA, kShift);
}

void Sheet::picture(const cv::Mat& bgr, const cv::Rect2d& area) {
  cv::Point offset;
  cv::Mat inside = part(area, &offset);
  if (inside.empty() || bgr.empty()) return;
  cv::resize(bgr, inside, inside.size(), 0.0, 0.0, cv::INTER_LINEAR);
}

void Sheet::text(const std::string& text, const cv::Point2d& anchor, double size,
                 const Colour& colour, Align align, bool bold) {
  const std::string plain = withSigns(text);
  const double width = textWidth(text, size, bold);
  const double left = anchor.x - (align == Align::kLeft     ? 0.0
                                  : align == Align::kCentre ? 0.5 * width
                                                            : width);
  const cv::Point origin(static_cast<int>(std::lround(left * kScale)),
                         static_cast<int>(std::lround(anchor.y * kScale)));
  const int weight = letterThickness(size, bold);
  cv::putText(large_, plain, origin, kFont, letterScale(size), colour, weight, cv::LINE_AA);
  for (std::size_t at = text.find(kPlusMinus); at != std::string::npos;
       at = text.find(kPlusMinus, at + kPlusMinus.size())) {
    const int before = largeWidth(withSigns(text.substr(0, at)), size, bold);
    const int sign = largeWidth("+", size, bold);
    const int y = origin.y + weight / 2;
    cv::line(large_, {origin.x + before + sign / 5, y}, {origin.x + before + sign * 4 / 5, y},
             colour, weight, cv::LINE_AA);
  }
}

double Sheet::textWidth(const std::string& text, double size, bool bold) {
  return static_cast<double>(largeWidth(withSigns(text), size, bold)) / kScale;
}

cv::Mat Sheet::image() const {
  cv::Mat small;
  cv::resize(large_, small, {large_.cols / kScale, large_.rows / kScale}, 0.0, 0.0, cv::INTER_AREA);
  return small;
}

}  // namespace camera_self_calibration
