#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace camera_self_calibration {

/// Which of several hypotheses their p-values reject, so that the probability of rejecting any true
/// one is at most `level` (Holm 1979).
inline std::vector<bool> rejectedByHolm(const std::vector<double>& p_values, double level) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return p_values[a] < p_values[b]; });
  std::vector<bool> rejected(p_values.size(), false);
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (!(p_values[order[i]] * static_cast<double>(order.size() - i) < level)) break;
    rejected[order[i]] = true;
  }
  return rejected;
}

}  // namespace camera_self_calibration
