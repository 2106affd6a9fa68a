#pragma once

#include <string>
#include <vector>

#include "camera_self_calibration/plotting/sheet.h"

namespace camera_self_calibration {

struct Range {
  double low = 0.0;
  double high = 1.0;
};

/// Round numbers (1, 2 or 5 times a power of ten apart) within a range, about `count` of them.
std::vector<double> roundTicks(const Range& range, int count);

/// A number with as many decimals as ticks `step` apart need.
std::string tickText(double value, double step);

/// A rectangle of a sheet with a scale in x and in y; y grows upwards.
struct Axes {
  cv::Rect2d area;
  Range x;
  Range y;
  bool logarithmic_y = false;  ///< Values must then be positive.

  cv::Point2d at(double x_value, double y_value) const;
};

/// The panel with its horizontal lines and their numbers at the left.
void drawAxes(const Axes& axes, const Palette& colours, Sheet* sheet);

/// Numbers and vertical lines of the x axis; `label` stands at the right end, below.
void drawXTicks(const Axes& axes, bool numbers, const std::string& label, const Palette& colours,
                Sheet* sheet);

}  // namespace camera_self_calibration
