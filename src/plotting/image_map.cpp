#include "camera_self_calibration/plotting/image_map.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/plotting/sheet.h"

namespace camera_self_calibration {
namespace {

constexpr double kMargin = 12.0;
constexpr double kTop = 26.0;
constexpr double kBottom = 40.0;  // scale of colours
constexpr int kCell = 16;         // pixels per value before scaling
const Colour kNothing(236, 232, 230);

double largestOf(const Eigen::MatrixXd& values) {
  double largest = 0.0;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (std::isfinite(values.data()[i])) largest = std::max(largest, values.data()[i]);
  }
  return largest;
}

/// Values between the grid's, from those of the four neighbours that exist.
double valueAt(const Eigen::MatrixXd& values, double row, double column, bool smooth) {
  const auto nearest = [](double at, Eigen::Index count) {
    return std::clamp<Eigen::Index>(std::lround(at), 0, count - 1);
  };
  const double own = values(nearest(row, values.rows()), nearest(column, values.cols()));
  if (!smooth || !std::isfinite(own)) return own;
  double sum = 0.0;
  double weight = 0.0;
  for (int dr = 0; dr <= 1; ++dr) {
    for (int dc = 0; dc <= 1; ++dc) {
      const double r = std::floor(row) + dr;
      const double c = std::floor(column) + dc;
      if (r < 0 || c < 0 || r >= values.rows() || c >= values.cols()) continue;
      const double value = values(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
      if (!std::isfinite(value)) continue;
      const double w = (1.0 - std::abs(row - r)) * (1.0 - std::abs(column - c));
      sum += w * value;
      weight += w;
    }
  }
  return weight > 0.0 ? sum / weight : own;
}

cv::Mat coloured(const ImageMap& map, double highest) {
  const int rows = kCell * static_cast<int>(map.values.rows());
  const int columns = kCell * static_cast<int>(map.values.cols());
  cv::Mat picture(rows, columns, CV_8UC3);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const double value =
          valueAt(map.values, (y + 0.5) / kCell - 0.5, (x + 0.5) / kCell - 0.5, map.smooth);
      const Colour colour = std::isfinite(value) ? errorColour(value / highest) : kNothing;
      for (int c = 0; c < 3; ++c) {
        picture.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<std::uint8_t>(colour[c]);
      }
    }
  }
  return picture;
}

std::string shortNumber(double value) {
  return value < 1000.0 ? formatted("%.3g", value) : formatted("%.0f", value);
}

void drawScale(const ImageMap& map, double highest, const cv::Rect2d& area, Sheet* sheet) {
  const Palette& colours = palette(Theme::kLight);
  const double y = area.y + area.height + 8.0;
  constexpr int kSteps = 60;
  const double width = 0.4 * area.width;
  for (int i = 0; i < kSteps; ++i) {
    sheet->fill({area.x + width * i / kSteps, y, width / kSteps + 0.5, 8.0},
                errorColour(i / (kSteps - 1.0)));
  }
  sheet->text("0", {area.x, y + 20.0}, 6.5, colours.faint_text);
  sheet->text(shortNumber(0.5 * highest), {area.x + 0.5 * width, y + 20.0}, 6.5, colours.faint_text,
              Align::kCentre);
  sheet->text(shortNumber(highest) + " " + map.unit, {area.x + width, y + 20.0}, 6.5,
              colours.faint_text, Align::kCentre);
  if (map.arrows.empty()) return;
  sheet->text("arrows " + shortNumber(map.arrow_scale) + " times as long",
              {area.x + area.width, y + 20.0}, 6.5, colours.faint_text, Align::kRight);
}

void drawArrow(const cv::Point2d& from, const cv::Point2d& to, const cv::Rect2d& area,
               Sheet* sheet) {
  const Colour ink(40, 40, 40);
  const cv::Point2d way = to - from;
  const double length = cv::norm(way);
  if (!(length > 0.5)) return;
  const cv::Point2d along = way * (1.0 / length);
  const cv::Point2d across(-along.y, along.x);
  const double head = std::min(5.0, 0.5 * length);
  sheet->curve({from, to}, ink, 1.0, area);
  sheet->curve(
      {to - along * head + across * (0.5 * head), to, to - along * head - across * (0.5 * head)},
      ink, 1.0, area);
}

void drawCross(const cv::Point2d& centre, const cv::Rect2d& area, Sheet* sheet) {
  const Colour ink(90, 90, 90);
  const cv::Point2d down(2.5, 2.5);
  const cv::Point2d up(2.5, -2.5);
  sheet->curve({centre - down, centre + down}, ink, 0.8, area);
  sheet->curve({centre - up, centre + up}, ink, 0.8, area);
}

}  // namespace

cv::Mat drawImageMap(const ImageMap& map, int width, bool fine) {
  const Palette& colours = palette(Theme::kLight);
  const double inner = width - 2.0 * kMargin;
  const double height = inner * map.image_height / std::max(1, map.image_width);
  const cv::Rect2d area(kMargin, kTop, inner, height);
  Sheet sheet(width, static_cast<int>(kTop + height + kBottom), colours.background);
  sheet.text(map.title, {kMargin, 16.0}, 8.0, colours.text, Align::kLeft, true);
  double highest = map.highest > 0.0 ? map.highest : largestOf(map.values);
  if (!(highest > 0.0)) highest = 1.0;
  if (map.values.size() > 0) sheet.picture(coloured(map, highest), area);
  const double scale = inner / std::max(1, map.image_width);
  for (const ImageMap::Arrow& arrow : map.arrows) {
    const Eigen::Vector2d from = scale * (arrow.pixel.array() + 0.5).matrix();
    const Eigen::Vector2d to = from + scale * map.arrow_scale * arrow.offset;
    drawArrow({area.x + from.x(), area.y + from.y()}, {area.x + to.x(), area.y + to.y()}, area,
              &sheet);
  }
  for (const Eigen::Vector2d& cross : map.crosses) {
    const Eigen::Vector2d at = scale * (cross.array() + 0.5).matrix();
    drawCross({area.x + at.x(), area.y + at.y()}, area, &sheet);
  }
  sheet.outline(area, colours.grid);
  drawScale(map, highest, area, &sheet);
  return fine ? sheet.fineImage() : sheet.image();
}

}  // namespace camera_self_calibration
