#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace camera_self_calibration {

/// The middle value (of an even count the upper one of the two) of one value or more, which change
/// their order: for loops that would not copy them each time.
inline double medianInPlace(std::vector<double>* values) {
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

/// The same of a copy; `fallback` without values.
inline double median(std::vector<double> values, double fallback) {
  return values.empty() ? fallback : medianInPlace(&values);
}

}  // namespace camera_self_calibration
