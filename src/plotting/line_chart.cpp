#include "camera_self_calibration/plotting/line_chart.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "camera_self_calibration/plotting/axes.h"

namespace camera_self_calibration {
namespace {

constexpr double kLeft = 66.0;
constexpr double kRight = 16.0;
constexpr double kTop = 22.0;     // title of a panel
constexpr double kBottom = 20.0;  // numbers of the x axis
constexpr double kTitle = 22.0;   // of the sheet
constexpr double kLegend = 28.0;  // below it
constexpr double kFooter = 16.0;
constexpr double kLetters = 7.5;

bool drawable(const LineChart& chart, double y) {
  return std::isfinite(y) && (!chart.logarithmic_y || y > 0.0);
}

double spreadAt(const Curve& curve, std::size_t i) {
  const double spread = i < curve.spread.size() ? curve.spread[i] : 0.0;
  return std::isfinite(spread) ? spread : 0.0;
}

Range xRange(const std::vector<LineChart>& charts) {
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const LineChart& chart : charts) {
    for (const Curve& curve : chart.curves) {
      if (curve.x.empty()) continue;
      range.low = std::min(range.low, curve.x.front());
      range.high = std::max(range.high, curve.x.back());
    }
  }
  if (!(range.high > range.low)) range = {0.0, 1.0};
  return range;
}

double quantileOf(std::vector<double> values, double share) {
  const auto position = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(position),
                   values.end());
  return values[position];
}

Range logarithmicRange(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {*low / 1.3, *high * 1.3};
}

/// About the median of the later values, so that `quantile` of the bounds fit in.
Range yRange(const LineChart& chart, double quantile) {
  std::vector<double> ends;
  std::vector<double> later;
  for (const Curve& curve : chart.curves) {
    for (std::size_t i = 0; i < curve.y.size(); ++i) {
      if (!drawable(chart, curve.y[i])) continue;
      if (2 * i >= curve.y.size()) later.push_back(curve.y[i]);
      ends.push_back(curve.y[i] + spreadAt(curve, i));
      ends.push_back(curve.y[i] - spreadAt(curve, i));
    }
  }
  if (ends.empty() || later.empty()) return {0.0, 1.0};
  if (chart.logarithmic_y) {
    ends.erase(std::remove_if(ends.begin(), ends.end(), [](double y) { return !(y > 0.0); }),
               ends.end());
    return logarithmicRange(ends);
  }
  const double centre = quantileOf(later, 0.5);
  for (double& end : ends) end = std::abs(end - centre);
  double half = 1.15 * quantileOf(ends, quantile);
  // The outcome of every curve is to be seen.
  for (const Curve& curve : chart.curves) {
    if (!curve.y.empty() && std::isfinite(curve.y.back())) {
      half = std::max(half, 1.1 * std::abs(curve.y.back() - centre));
    }
  }
  if (chart.level) half = std::max(half, 1.1 * std::abs(*chart.level - centre));
  half = std::max({half, 1e-9, 1e-6 * std::abs(centre)});
  return {centre - half, centre + half};
}

void drawCurve(const LineChart& chart, const Curve& curve, const Axes& axes, bool bounds,
               Sheet* sheet) {
  std::vector<cv::Point2d> middle, upper, lower;
  for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
    if (!drawable(chart, curve.y[i])) continue;
    middle.push_back(axes.at(curve.x[i], curve.y[i]));
    upper.push_back(axes.at(curve.x[i], curve.y[i] + spreadAt(curve, i)));
    lower.push_back(axes.at(curve.x[i], curve.y[i] - spreadAt(curve, i)));
  }
  if (!bounds) {
    sheet->curve(middle, curve.colour, 1.4, axes.area, curve.dashed);
    return;
  }
  if (curve.spread.empty()) return;
  if (curve.dashed) {
    sheet->curve(upper, curve.colour, 0.8, axes.area, true);
    sheet->curve(lower, curve.colour, 0.8, axes.area, true);
    return;
  }
  upper.insert(upper.end(), lower.rbegin(), lower.rend());
  sheet->polygon(upper, curve.colour, axes.area, 0.25);
}

void drawPanel(const LineChart& chart, const Axes& axes, const Palette& colours, Sheet* sheet) {
  const cv::Rect2d& area = axes.area;
  sheet->fill(area, colours.panel);
  for (const Curve& curve : chart.curves) {
    if (!curve.dashed) drawCurve(chart, curve, axes, true, sheet);
  }
  drawAxes(axes, colours, sheet);
  drawXTicks(axes, true, "", colours, sheet);
  if (chart.level && *chart.level > axes.y.low && *chart.level < axes.y.high) {
    sheet->line(axes.at(axes.x.low, *chart.level), axes.at(axes.x.high, *chart.level),
                colours.truth, 0.9);
  }
  for (const double mark : chart.marks) {
    const double x = axes.at(mark, axes.y.low).x;
    sheet->dashes({x, area.y}, {x, area.y + area.height}, colours.faint_text, 0.8);
  }
  for (const Curve& curve : chart.curves) {
    if (curve.dashed) drawCurve(chart, curve, axes, true, sheet);
  }
  for (const Curve& curve : chart.curves) drawCurve(chart, curve, axes, false, sheet);
  sheet->text(chart.title, {area.x, area.y - 6.0}, kLetters, colours.text, Align::kLeft, true);
  sheet->text(chart.note, {area.x + area.width, area.y - 6.0}, kLetters, colours.faint_text,
              Align::kRight);
}

bool hasLegend(const std::vector<LineChart>& charts, const LineChartSheet& style) {
  if (charts.empty()) return false;
  if (!style.level_name.empty()) return true;
  const std::vector<Curve>& curves = charts.front().curves;
  return std::any_of(curves.begin(), curves.end(), [](const Curve& c) { return !c.name.empty(); });
}

void drawLegend(const std::vector<LineChart>& charts, const LineChartSheet& style, double top,
                const Palette& colours, Sheet* sheet) {
  double x = kLeft;
  const auto entry = [&](const std::string& name, const Colour& colour, bool dashed) {
    if (name.empty()) return;
    const double y = top + 14.5;
    const cv::Rect2d all(0.0, top, style.width, kLegend);
    sheet->curve({{x, y}, {x + 26.0, y}}, colour, 2.0, all, dashed);
    sheet->text(name, {x + 32.0, y + 3.5}, kLetters, colours.text);
    x += 32.0 + Sheet::textWidth(name, kLetters) + 22.0;
  };
  for (const Curve& curve : charts.front().curves) entry(curve.name, curve.colour, curve.dashed);
  entry(style.level_name, colours.truth, false);
}

}  // namespace

Sheet drawLineCharts(const std::vector<LineChart>& charts, const LineChartSheet& style) {
  const Palette& colours = palette(Theme::kLight);
  const int columns = std::max(1, style.columns);
  const int rows = (static_cast<int>(charts.size()) + columns - 1) / columns;
  const double legend_top = style.title.empty() ? 0.0 : kTitle;
  const double header = legend_top + (hasLegend(charts, style) ? kLegend : 0.0);
  const int height = static_cast<int>(header + kFooter) + rows * style.panel_height;
  Sheet sheet(style.width, height, colours.background);
  sheet.text(style.title, {kLeft, 20.0}, 9.5, colours.text, Align::kLeft, true);
  if (!charts.empty()) drawLegend(charts, style, legend_top, colours, &sheet);
  const Range x = xRange(charts);
  const double width = static_cast<double>(style.width) / columns;
  for (std::size_t i = 0; i < charts.size(); ++i) {
    const int column = static_cast<int>(i) % columns;
    const int row = static_cast<int>(i) / columns;
    const cv::Rect2d area(width * column + kLeft, header + style.panel_height * row + kTop,
                          width - kLeft - kRight, style.panel_height - kTop - kBottom);
    const Axes axes{area, x, yRange(charts[i], style.quantile), charts[i].logarithmic_y};
    drawPanel(charts[i], axes, colours, &sheet);
  }
  sheet.text(style.x_label, {style.width - kRight, height - 4.0}, 6.5, colours.faint_text,
             Align::kRight);
  return sheet;
}

}  // namespace camera_self_calibration
