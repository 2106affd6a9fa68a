#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "camera_self_calibration/base/formatted.h"

namespace camera_self_calibration {

// Numbers as they stand in reports.

/// "-" for what is not a finite number.
inline std::string number(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  const std::string text = formatted("%.*f", decimals, value);
  const bool zero = text.find_first_not_of("-0.") == std::string::npos;
  return zero && text.front() == '-' ? text.substr(1) : text;
}

/// Decimals that show two digits of a sigma.
inline int decimalsFor(double sigma) {
  if (!(sigma > 0.0) || !std::isfinite(sigma)) return 4;
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, 8);
}

/// Of an error that grows by a share.
inline std::string percent(double share, int decimals = 1) {
  if (!std::isfinite(share)) return "not observable without it";
  return number(100.0 * share, decimals) + " %";
}

/// Beside parameters with their sigmas.
constexpr const char* kSigmaMeaning =
    "Sigma is one standard deviation of noise, larger where segments of the video disagree. It "
    "contains no misfit of the lens model and nothing that halves of the video disagree beyond it; "
    "the expected error in pixels contains both.";

}  // namespace camera_self_calibration
