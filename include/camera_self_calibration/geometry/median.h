#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace camera_self_calibration {

/// The middle value (of an even count the upper one of the two); `fallback` without values.
inline double median(std::vector<double> values, double fallback) {
  if (values.empty()) return fallback;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace camera_self_calibration
