#include "camera_self_calibration/plotting/axes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "camera_self_calibration/base/formatted.h"

namespace camera_self_calibration {
namespace {

constexpr double kTickText = 6.5;

/// Powers of ten within the range; 2 and 5 times those too, where they would be few.
std::vector<double> logarithmicTicks(const Range& range) {
  const bool few = range.high < 100.0 * range.low;
  const std::vector<double> steps =
      few ? std::vector<double>{1.0, 2.0, 5.0} : std::vector<double>{1.0};
  std::vector<double> ticks;
  for (double power = std::pow(10.0, std::floor(std::log10(range.low))); power <= range.high;
       power *= 10.0) {
    for (const double step : steps) {
      const double tick = step * power;
      if (tick >= range.low && tick <= range.high) ticks.push_back(tick);
    }
  }
  return ticks;
}

double stepOf(const std::vector<double>& ticks) {
  return ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0;
}

}  // namespace

std::vector<double> roundTicks(const Range& range, int count) {
  const double raw = (range.high - range.low) / std::max(1, count);
  if (!(raw > 0.0) || !std::isfinite(raw)) return {};
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double share = raw / power;
  const double step = power * (share < 1.5 ? 1.0 : share < 3.5 ? 2.0 : share < 7.5 ? 5.0 : 10.0);
  std::vector<double> ticks;
  const double first = std::ceil(range.low / step - 1e-9);
  for (int i = 0; i < 100 && (first + i) * step <= range.high + 1e-9 * step; ++i) {
    ticks.push_back((first + i) * step);
  }
  return ticks;
}

std::string tickText(double value, double step) {
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  return formatted("%.*f", decimals, value);
}

cv::Point2d Axes::at(double x_value, double y_value) const {
  const double sx = (x_value - x.low) / (x.high - x.low);
  const double sy = logarithmic_y ? std::log(y_value / y.low) / std::log(y.high / y.low)
                                  : (y_value - y.low) / (y.high - y.low);
  return {area.x + sx * area.width, area.y + area.height * (1.0 - sy)};
}

void drawAxes(const Axes& axes, const Palette& colours, Sheet* sheet) {
  const int count = std::max(2, static_cast<int>(axes.area.height / 26.0));
  const std::vector<double> ticks =
      axes.logarithmic_y ? logarithmicTicks(axes.y) : roundTicks(axes.y, count);
  double last_y = std::numeric_limits<double>::infinity();
  for (const double tick : ticks) {
    const double y = axes.at(axes.x.low, tick).y;
    sheet->line({axes.area.x, y}, {axes.area.x + axes.area.width, y}, colours.grid, 0.5);
    if (last_y - y < 1.5 * kTickText) continue;  // no room for another number
    last_y = y;
    sheet->text(axes.logarithmic_y ? formatted("%g", tick) : tickText(tick, stepOf(ticks)),
                {axes.area.x - 6.0, y + 0.5 * kTickText}, kTickText, colours.faint_text,
                Align::kRight);
  }
}

void drawXTicks(const Axes& axes, bool numbers, const std::string& label, const Palette& colours,
                Sheet* sheet) {
  const double bottom = axes.area.y + axes.area.height;
  const std::vector<double> ticks =
      roundTicks(axes.x, std::max(2, static_cast<int>(axes.area.width / 80.0)));
  for (const double tick : ticks) {
    const double x = axes.at(tick, axes.y.low).x;
    sheet->line({x, axes.area.y}, {x, bottom}, colours.grid, 0.5);
    if (!numbers) continue;
    sheet->text(tickText(tick, stepOf(ticks)), {x, bottom + 14.0}, kTickText, colours.faint_text,
                Align::kCentre);
  }
  if (label.empty()) return;
  sheet->text(label, {axes.area.x + axes.area.width, bottom + 26.0}, kTickText, colours.faint_text,
              Align::kRight);
}

}  // namespace camera_self_calibration
