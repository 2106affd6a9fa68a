#include "chart_text.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/plotting/sheet.h"

namespace camera_self_calibration {
namespace {

std::string number(double value, int decimals) { return formatted("%.*f", decimals, value); }

/// So that two digits of `spread` are seen.
int decimalsFor(double spread) {
  if (!(spread > 0.0) || !std::isfinite(spread)) return 3;
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(spread))), 0, 8);
}

}  // namespace

std::string modelText(const Camera& camera) {
  return toString(camera.model()) + ", " + std::to_string(camera.width()) + " x " +
         std::to_string(camera.height());
}

std::string errorText(const CalibrationReport& report) {
  if (report.covariance.size() == 0 || !std::isfinite(report.uncertainty.rms)) return {};
  const PixelError& error = report.uncertainty;
  return "expected error " + number(error.rms, decimalsFor(error.rms)) + " px rms, " +
         number(error.max, decimalsFor(error.rms)) + " px at most";
}

std::string parameterTitle(const Camera& camera, int index) {
  const std::string name = camera.parameterNames()[static_cast<std::size_t>(index)];
  if (index < 4) return name + " [px]";
  return name == "w" ? name + " [rad]" : name;
}

std::string valueText(double value, double sigma) {
  if (std::isnan(sigma)) return number(value, 3) + ", not known yet";
  if (sigma == 0.0) return "held at " + number(value, 5);
  const int decimals = decimalsFor(3.0 * sigma);
  return number(value, decimals) + " \u00b1 " + number(3.0 * sigma, decimals) + " (3 sigma)";
}

std::string fitted(const std::string& text, double width, double size) {
  if (Sheet::textWidth(text, size) <= width) return text;
  std::string shorter = text;
  while (!shorter.empty() && Sheet::textWidth(shorter + " ...", size) > width) shorter.pop_back();
  return shorter + " ...";
}

}  // namespace camera_self_calibration
