#include "camera_self_calibration/plotting/histogram.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/plotting/axes.h"

namespace camera_self_calibration {
namespace {

constexpr double kReach = 5.0;  // sigmas
constexpr int kBars = 50;

/// Density per bar; what lies beyond the ends counts in none.
std::vector<double> densities(const std::vector<double>& values) {
  std::vector<double> density(kBars, 0.0);
  constexpr double kWidth = 2.0 * kReach / kBars;
  for (const double value : values) {
    const double position = (value + kReach) / kWidth;
    if (position >= 0.0 && position < kBars) density[static_cast<std::size_t>(position)] += 1.0;
  }
  const double count = std::max<double>(1.0, static_cast<double>(values.size()));
  for (double& bar : density) bar /= count * kWidth;
  return density;
}

double normalDensity(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2.0 * M_PI); }

}  // namespace

cv::Mat drawResidualHistogram(const std::vector<double>& whitened, const std::string& note,
                              int width, int height, bool fine) {
  const Palette& colours = palette(Theme::kLight);
  Sheet sheet(width, height, colours.background);
  const std::vector<double> density = densities(whitened);
  const double top =
      1.15 * std::max(normalDensity(0.0), *std::max_element(density.begin(), density.end()));
  const Axes axes{{48.0, 26.0, width - 60.0, height - 62.0}, {-kReach, kReach}, {0.0, top}, false};
  sheet.fill(axes.area, colours.panel);
  drawAxes(axes, colours, &sheet);
  drawXTicks(axes, true, "residual / sigma", colours, &sheet);
  for (int i = 0; i < kBars; ++i) {
    const double left = -kReach + 2.0 * kReach * i / kBars;
    const cv::Point2d upper = axes.at(left, density[static_cast<std::size_t>(i)]);
    const cv::Point2d lower = axes.at(left + 2.0 * kReach / kBars, 0.0);
    sheet.fill({upper.x + 0.5, upper.y, lower.x - upper.x - 1.0, lower.y - upper.y},
               colours.curve * 0.6 + Colour(255, 255, 255) * 0.4);
  }
  std::vector<cv::Point2d> normal;
  for (double x = -kReach; x <= kReach; x += 0.1) normal.push_back(axes.at(x, normalDensity(x)));
  sheet.curve(normal, colours.truth, 1.4, axes.area);
  sheet.text("residuals over sigma; red: normal distribution", {axes.area.x, 16.0}, 7.5,
             colours.text, Align::kLeft, true);
  sheet.text(note, {axes.area.x + axes.area.width, 16.0}, 7.5, colours.faint_text, Align::kRight);
  return fine ? sheet.fineImage() : sheet.image();
}

}  // namespace camera_self_calibration
