#include "camera_self_calibration/plotting/image_map.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/plotting/sheet.h"

namespace camera_self_calibration {
namespace {

constexpr double kMargin = 12.0;
constexpr double kTop = 26.0;
constexpr double kBottom = 40.0;  // scale of colours

double largestOf(const Eigen::MatrixXd& values) {
  double largest = 0.0;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (std::isfinite(values.data()[i])) largest = std::max(largest, values.data()[i]);
  }
  return largest;
}

void drawCells(const ImageMap& map, double highest, const cv::Rect2d& area, Sheet* sheet) {
  const double width = area.width / static_cast<double>(map.values.cols());
  const double height = area.height / static_cast<double>(map.values.rows());
  // A little larger than it is, so that no lines are seen between cells.
  constexpr double kOverlap = 0.3;
  for (Eigen::Index row = 0; row < map.values.rows(); ++row) {
    for (Eigen::Index column = 0; column < map.values.cols(); ++column) {
      const double value = map.values(row, column);
      if (!std::isfinite(value)) continue;
      const cv::Rect2d cell(area.x + width * static_cast<double>(column),
                            area.y + height * static_cast<double>(row), width + kOverlap,
                            height + kOverlap);
      sheet->fill(cell & area, errorColour(value / highest));
    }
  }
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

Sheet drawImageMap(const ImageMap& map, int width) {
  const Palette& colours = palette(Theme::kLight);
  const double inner = width - 2.0 * kMargin;
  const double height = inner * map.image_height / std::max(1, map.image_width);
  const cv::Rect2d area(kMargin, kTop, inner, height);
  Sheet sheet(width, static_cast<int>(kTop + height + kBottom), colours.background);
  sheet.text(map.title, {kMargin, 16.0}, 8.0, colours.text, Align::kLeft, true);
  double highest = map.highest > 0.0 ? map.highest : largestOf(map.values);
  if (!(highest > 0.0)) highest = 1.0;
  sheet.fill(area, colours.grid);
  drawCells(map, highest, area, &sheet);
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
  return sheet;
}

}  // namespace camera_self_calibration
