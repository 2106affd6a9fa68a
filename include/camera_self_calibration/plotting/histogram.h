#pragma once

#include <string>
#include <vector>

#include "camera_self_calibration/plotting/sheet.h"

namespace camera_self_calibration {

/// A residual over its sigma, and the standard deviation that this should have.
struct WhitenedResidual {
  double value = 0.0;
  double expected = 1.0;
};

/// The values as bars between -5 and 5, beside the density that they would have if the sigmas were
/// right: the mean of the normal densities of the expected standard deviations. `note` stands
/// above, at the right.
Sheet drawResidualHistogram(const std::vector<WhitenedResidual>& residuals, const std::string& note,
                            int width, int height);

}  // namespace camera_self_calibration
