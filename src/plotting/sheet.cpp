#include "camera_self_calibration/plotting/sheet.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

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

constexpr double kDash = 5.0;

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

/// The pieces of a line that are drawn where it is dashed.
std::vector<std::vector<cv::Point2d>> dashesOf(const std::vector<cv::Point2d>& points) {
  std::vector<std::vector<cv::Point2d>> pieces;
  double along = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double length = cv::norm(points[i] - points[i - 1]);
    const auto point = [&](double s) {
      return points[i - 1] + (points[i] - points[i - 1]) * (std::min(s, length) / length);
    };
    for (double at = 0.0; at < length;) {
      const double phase = std::fmod(along + at, 2.0 * kDash);
      const double next = phase < kDash ? kDash : 2.0 * kDash;
      const double step = std::min(length - at, next - phase) + 1e-6;
      if (phase < kDash) pieces.push_back({point(at), point(at + step)});
      at += step;
    }
    along += length;
  }
  return pieces;
}

/// Paints shapes at twice the size of the sheet.
class Painter {
 public:
  Painter(int width, int height, const Colour& background)
      : large_(height * kScale, width * kScale, CV_8UC3, background) {}

  void operator()(const shape::Fill& fill) {
    blend(fill.area, fill.opacity,
          [&](cv::Mat* inside, const cv::Point&) { inside->setTo(fill.colour); });
  }

  void operator()(const shape::Outline& outline) {
    cv::rectangle(large_, scaled(outline.area), outline.colour, 1);
  }

  void operator()(const shape::Curve& curve) {
    cv::Point offset;
    cv::Mat inside = curve.area ? part(*curve.area, &offset) : large_;
    if (inside.empty() || curve.points.empty()) return;
    const std::vector<std::vector<cv::Point2d>> runs =
        curve.dashed ? dashesOf(curve.points) : std::vector<std::vector<cv::Point2d>>{curve.points};
    for (const std::vector<cv::Point2d>& run : runs) {
      cv::polylines(inside, fixed(run, offset), false, curve.colour, thickness(curve.width),
                    cv::LINE_AA, kShift);
    }
  }

  void operator()(const shape::Polygon& polygon) {
    if (polygon.points.size() < 3) return;
    blend(polygon.area, polygon.opacity, [&](cv::Mat* inside, const cv::Point& offset) {
      const std::vector<std::vector<cv::Point>> polygons = {fixed(polygon.points, offset)};
      cv::fillPoly(*inside, polygons, polygon.colour, cv::LINE_AA, kShift);
    });
  }

  void operator()(const shape::Disc& disc) {
    cv::circle(large_, fixed(disc.centre), static_cast<int>(disc.radius * kScale * kFixed),
               disc.colour, cv::FILLED, cv::LINE_AA, kShift);
  }

  void operator()(const shape::Text& text) {
    const std::string plain = withSigns(text.text);
    const double width = Sheet::textWidth(text.text, text.size, text.bold);
    const double left = text.anchor.x - (text.align == Align::kLeft     ? 0.0
                                         : text.align == Align::kCentre ? 0.5 * width
                                                                        : width);
    const cv::Point origin(static_cast<int>(std::lround(left * kScale)),
                           static_cast<int>(std::lround(text.anchor.y * kScale)));
    cv::putText(large_, plain, origin, kFont, letterScale(text.size), text.colour,
                letterThickness(text.size, text.bold), cv::LINE_AA);
    underlinePluses(text, origin);
  }

  const cv::Mat& picture() const { return large_; }

 private:
  /// The part of the picture that an area covers, and where it begins.
  cv::Mat part(const cv::Rect2d& area, cv::Point* offset) {
    const cv::Rect inside = scaled(area) & cv::Rect(0, 0, large_.cols, large_.rows);
    *offset = inside.tl();
    return large_(inside);
  }

  template <typename Paint>
  void blend(const cv::Rect2d& area, double opacity, Paint paint) {
    cv::Point offset;
    cv::Mat inside = part(area, &offset);
    if (inside.empty()) return;
    if (opacity >= 1.0) return paint(&inside, offset);
    cv::Mat painted = inside.clone();
    paint(&painted, offset);
    cv::addWeighted(painted, opacity, inside, 1.0 - opacity, 0.0, inside);
  }

  void underlinePluses(const shape::Text& text, const cv::Point& origin) {
    const int weight = letterThickness(text.size, text.bold);
    for (std::size_t at = text.text.find(kPlusMinus); at != std::string::npos;
         at = text.text.find(kPlusMinus, at + kPlusMinus.size())) {
      const int before = largeWidth(withSigns(text.text.substr(0, at)), text.size, text.bold);
      const int sign = largeWidth("+", text.size, text.bold);
      const int y = origin.y + weight / 2;
      cv::line(large_, {origin.x + before + sign / 5, y}, {origin.x + before + sign * 4 / 5, y},
               text.colour, weight, cv::LINE_AA);
    }
  }

  cv::Mat large_;
};

}  // namespace

Sheet::Sheet(int width, int height, const Colour& background)
    : width_(width), height_(height), background_(background) {}

void Sheet::fill(const cv::Rect2d& area, const Colour& colour, double opacity) {
  shapes_.push_back(shape::Fill{area, colour, opacity});
}

void Sheet::outline(const cv::Rect2d& area, const Colour& colour) {
  shapes_.push_back(shape::Outline{area, colour});
}

void Sheet::line(const cv::Point2d& from, const cv::Point2d& to, const Colour& colour,
                 double width) {
  shapes_.push_back(shape::Curve{{from, to}, colour, width, false, std::nullopt});
}

void Sheet::dashes(const cv::Point2d& from, const cv::Point2d& to, const Colour& colour,
                   double width) {
  shapes_.push_back(shape::Curve{{from, to}, colour, width, true, std::nullopt});
}

void Sheet::disc(const cv::Point2d& centre, double radius, const Colour& colour) {
  shapes_.push_back(shape::Disc{centre, radius, colour});
}

void Sheet::curve(const std::vector<cv::Point2d>& points, const Colour& colour, double width,
                  const cv::Rect2d& area, bool dashed) {
  if (!points.empty()) shapes_.push_back(shape::Curve{points, colour, width, dashed, area});
}

void Sheet::polygon(const std::vector<cv::Point2d>& points, const Colour& colour,
                    const cv::Rect2d& area, double opacity) {
  shapes_.push_back(shape::Polygon{points, colour, opacity, area});
}

void Sheet::text(const std::string& text, const cv::Point2d& anchor, double size,
                 const Colour& colour, Align align, bool bold) {
  if (!text.empty()) shapes_.push_back(shape::Text{text, anchor, size, colour, align, bold});
}

double Sheet::textWidth(const std::string& text, double size, bool bold) {
  return static_cast<double>(largeWidth(withSigns(text), size, bold)) / kScale;
}

cv::Mat Sheet::fineImage() const {
  Painter painter(width_, height_, background_);
  for (const Shape& shape : shapes_) std::visit(painter, shape);
  return painter.picture();
}

cv::Mat Sheet::image() const {
  cv::Mat small;
  cv::resize(fineImage(), small, {width_, height_}, 0.0, 0.0, cv::INTER_AREA);
  return small;
}

}  // namespace camera_self_calibration
