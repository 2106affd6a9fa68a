#include "camera_self_calibration/plotting/histogram.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "camera_self_calibration/plotting/axes.h"

namespace camera_self_calibration {
namespace {

constexpr double kReach = 5.0;  // sigmas
constexpr int kBars = 50;

/// Density per bar; what lies beyond the ends counts in none.
std::vector<double> densities(const std::vector<WhitenedResidual>& residuals) {
  std::vector<double> density(kBars, 0.0);
  constexpr double kWidth = 2.0 * kReach / kBars;
  for (const WhitenedResidual& residual : residuals) {
    const double position = (residual.value + kReach) / kWidth;
    if (position >= 0.0 && position < kBars) density[static_cast<std::size_t>(position)] += 1.0;
  }
  const double count = std::max<double>(1.0, static_cast<double>(residuals.size()));
  for (double& bar : density) bar /= count * kWidth;
  return density;
}

/// Many residuals, few different widths: how often each occurs, in steps of a hundredth.
std::map<int, double> widths(const std::vector<WhitenedResidual>& residuals) {
  std::map<int, double> counts;
  for (const WhitenedResidual& residual : residuals) {
    counts[std::max(1, static_cast<int>(std::lround(100.0 * residual.expected)))] += 1.0;
  }
  return counts;
}

double expectedDensity(const std::map<int, double>& widths, double x) {
  double sum = 0.0;
  double count = 0.0;
  for (const auto& [hundredths, number] : widths) {
    const double sigma = 0.01 * hundredths;
    sum += number * std::exp(-0.5 * x * x / (sigma * sigma)) / (std::sqrt(2.0 * M_PI) * sigma);
    count += number;
  }
  return count > 0.0 ? sum / count : 0.0;
}

}  // namespace

Sheet drawResidualHistogram(const std::vector<WhitenedResidual>& residuals, const std::string& note,
                            int width, int height) {
  const Palette& colours = palette(Theme::kLight);
  Sheet sheet(width, height, colours.background);
  const std::vector<double> density = densities(residuals);
  const std::map<int, double> expected = widths(residuals);
  const double top = 1.15 * std::max({0.1, expectedDensity(expected, 0.0),
                                      *std::max_element(density.begin(), density.end())});
  const Axes axes{{48.0, 26.0, width - 60.0, height - 62.0}, {-kReach, kReach}, {0.0, top}, false};
  sheet.fill(axes.area, colours.panel);
  drawAxes(axes, colours, &sheet);
  drawXTicks(axes, true, "residual / sigma", colours, &sheet);
  for (int i = 0; i < kBars; ++i) {
    const double left = -kReach + 2.0 * kReach * i / kBars;
    const cv::Point2d upper = axes.at(left, density[static_cast<std::size_t>(i)]);
    const cv::Point2d lower = axes.at(left + 2.0 * kReach / kBars, 0.0);
    sheet.fill({upper.x + 0.5, upper.y, lower.x - upper.x - 1.0, lower.y - upper.y}, colours.curve,
               0.6);
  }
  std::vector<cv::Point2d> curve;
  for (double x = -kReach; x <= kReach; x += 0.05) {
    curve.push_back(axes.at(x, expectedDensity(expected, x)));
  }
  sheet.curve(curve, colours.truth, 1.4, axes.area);
  sheet.text("residuals over sigma; red: expected", {axes.area.x, 16.0}, 7.5, colours.text,
             Align::kLeft, true);
  sheet.text(note, {axes.area.x + axes.area.width, 16.0}, 7.5, colours.faint_text, Align::kRight);
  return sheet;
}

}  // namespace camera_self_calibration
