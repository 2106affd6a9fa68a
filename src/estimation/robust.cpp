#include "camera_self_calibration/estimation/robust.h"

namespace camera_self_calibration {
namespace {

// Lower regularised incomplete gamma function by its power series; for x < a + 1.
double lowerGammaSeries(double a, double x) {
  double term = 1.0 / a;
  double sum = term;
  for (int n = 1; n < 1000 && term > sum * 1e-16; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return sum * std::exp(-x + a * std::log(x) - std::lgamma(a));
}

// Upper regularised incomplete gamma function by Lentz's continued fraction; for x >= a + 1.
double upperGammaFraction(double a, double x) {
  constexpr double kTiny = 1e-300;
  double b = x + 1.0 - a;
  double c = 1.0 / kTiny;
  double d = 1.0 / b;
  double h = d;
  for (int n = 1; n < 1000; ++n) {
    const double an = -n * (n - a);
    b += 2.0;
    d = an * d + b;
    d = 1.0 / (std::abs(d) < kTiny ? kTiny : d);
    c = b + an / c;
    if (std::abs(c) < kTiny) c = kTiny;
    const double factor = c * d;
    h *= factor;
    if (std::abs(factor - 1.0) < 1e-15) break;
  }
  return h * std::exp(-x + a * std::log(x) - std::lgamma(a));
}

}  // namespace

double chiSquareExceedance(double value, int degrees_of_freedom) {
  if (!(value > 0.0)) return 1.0;
  const double a = 0.5 * degrees_of_freedom;
  const double x = 0.5 * value;
  return x < a + 1.0 ? 1.0 - lowerGammaSeries(a, x) : upperGammaFraction(a, x);
}

double chiSquareQuantile(int degrees_of_freedom, double exceed_probability) {
  // The exceedance falls monotonically: bisect.
  double low = 0.0;
  double high = degrees_of_freedom + 10.0;
  while (chiSquareExceedance(high, degrees_of_freedom) > exceed_probability) high *= 2.0;
  while (high - low > 1e-13 * high) {
    const double middle = 0.5 * (low + high);
    (chiSquareExceedance(middle, degrees_of_freedom) > exceed_probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace camera_self_calibration
