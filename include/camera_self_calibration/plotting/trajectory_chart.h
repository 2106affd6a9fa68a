#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "camera_self_calibration/plotting/sheet.h"

namespace camera_self_calibration {

/// A way seen from above.
struct PlanePath {
  std::string name;  ///< In the legend; empty: not there.
  Colour colour;
  double width = 1.2;                   ///< Of the line [px].
  std::vector<Eigen::Vector2d> points;  ///< One that is not finite interrupts the line.
};

/// The paths in one frame, with equal scales on both axes; the first path's ends are marked.
Sheet drawPaths(const std::vector<PlanePath>& paths, const std::string& title,
                const std::string& unit, int width, int height);

}  // namespace camera_self_calibration
