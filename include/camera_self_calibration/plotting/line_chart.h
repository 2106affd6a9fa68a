#pragma once

#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/plotting/sheet.h"

namespace camera_self_calibration {

/// A quantity over x with what is known of its error.
struct Curve {
  std::string name;  ///< In the legend; empty: not there.
  Colour colour;
  bool dashed = false;         ///< The curve and its bounds.
  std::vector<double> x;       ///< Increasing.
  std::vector<double> y;       ///< As many; those that are not finite are left out.
  std::vector<double> spread;  ///< Half the width of the band about y; empty: none.
};

/// One panel.
struct LineChart {
  std::string title;  ///< Above, left.
  std::string note;   ///< Above, right.
  std::vector<Curve> curves;
  std::optional<double> level;  ///< A known value: a dashed line.
  std::vector<double> marks;    ///< Vertical lines.
  bool logarithmic_y = false;   ///< Only positive values are drawn.
};

struct LineChartSheet {
  std::string title;
  std::string x_label;
  std::string level_name;  ///< In the legend; empty: not there.
  int columns = 2;
  int width = 1000;        ///< [px]
  int panel_height = 150;  ///< [px]
  double quantile = 0.85;  ///< Of the values fits into the panels: the wild beginning is cut off.
};

/// Panels in columns below a title and the legend of the first panel's curves.
Sheet drawLineCharts(const std::vector<LineChart>& charts, const LineChartSheet& style);

}  // namespace camera_self_calibration
