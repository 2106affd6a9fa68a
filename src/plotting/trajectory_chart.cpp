#include "camera_self_calibration/plotting/trajectory_chart.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "camera_self_calibration/plotting/axes.h"

namespace camera_self_calibration {
namespace {

Eigen::AlignedBox2d extent(const std::vector<PlanePath>& paths) {
  Eigen::AlignedBox2d box;
  for (const PlanePath& path : paths) {
    for (const Eigen::Vector2d& point : path.points) {
      if (point.allFinite()) box.extend(point);
    }
  }
  if (box.isEmpty()) box.extend(Eigen::Vector2d(0.0, 0.0));
  return box;
}

/// Axes with as many units a pixel in x as in y.
Axes equalAxes(const Eigen::AlignedBox2d& box, const cv::Rect2d& area) {
  const Eigen::Vector2d centre = box.center();
  const Eigen::Vector2d size = box.sizes().cwiseMax(1e-9);
  const double per_pixel = 1.08 * std::max(size.x() / area.width, size.y() / area.height);
  const Eigen::Vector2d half = 0.5 * per_pixel * Eigen::Vector2d(area.width, area.height);
  return {area,
          {centre.x() - half.x(), centre.x() + half.x()},
          {centre.y() - half.y(), centre.y() + half.y()},
          false};
}

void drawPath(const PlanePath& path, const Axes& axes, Sheet* sheet) {
  std::vector<cv::Point2d> run;
  for (const Eigen::Vector2d& point : path.points) {
    if (point.allFinite()) {
      run.push_back(axes.at(point.x(), point.y()));
      continue;
    }
    sheet->curve(run, path.colour, path.width, axes.area);
    run.clear();
  }
  sheet->curve(run, path.colour, path.width, axes.area);
}

void markEnds(const PlanePath& path, const Axes& axes, const Palette& colours, Sheet* sheet) {
  const auto mark = [&](const Eigen::Vector2d& point, const std::string& name) {
    if (!point.allFinite()) return;
    const cv::Point2d at = axes.at(point.x(), point.y());
    sheet->disc(at, 3.5, path.colour);
    sheet->text(name, {at.x + 6.0, at.y - 4.0}, 7.0, colours.text);
  };
  if (path.points.empty()) return;
  mark(path.points.front(), "start");
  mark(path.points.back(), "end");
}

}  // namespace

Sheet drawPaths(const std::vector<PlanePath>& paths, const std::string& title,
                const std::string& unit, int width, int height) {
  const Palette& colours = palette(Theme::kLight);
  Sheet sheet(width, height, colours.background);
  const Axes axes = equalAxes(extent(paths), {56.0, 44.0, width - 72.0, height - 82.0});
  sheet.fill(axes.area, colours.panel);
  drawAxes(axes, colours, &sheet);
  drawXTicks(axes, true, unit, colours, &sheet);
  sheet.text(title, {56.0, 16.0}, 8.0, colours.text, Align::kLeft, true);
  // The first path last, so that it lies on top.
  for (auto path = paths.rbegin(); path != paths.rend(); ++path) drawPath(*path, axes, &sheet);
  double x = 56.0;
  for (const PlanePath& path : paths) {
    if (path.name.empty()) continue;
    sheet.line({x, 30.0}, {x + 22.0, 30.0}, path.colour, 2.0);
    sheet.text(path.name, {x + 28.0, 33.5}, 7.0, colours.text);
    x += 50.0 + Sheet::textWidth(path.name, 7.0);
  }
  if (!paths.empty()) markEnds(paths.front(), axes, colours, &sheet);
  return sheet;
}

}  // namespace camera_self_calibration
