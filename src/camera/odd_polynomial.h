#pragma once

#include <array>
#include <optional>

namespace camera_self_calibration {

/// y(x) = x (1 + c0 x^2 + c1 x^4 + c2 x^6 + c3 x^8): the radial part of radtan (x a normalised
/// radius) and of equidistant (x an angle).
struct OddPolynomial {
  std::array<double, 4> c;

  double value(double x) const;
  double slope(double x) const;

  /// The largest x up to which y grows, at most `end`.
  double monotonicLimit(double end) const;

  /// The x in [0, limit] with y(x) = y, for a limit up to which the polynomial is monotonic;
  /// nothing where y is negative, not finite or above y(limit).
  std::optional<double> inverse(double y, double limit) const;
};

}  // namespace camera_self_calibration
