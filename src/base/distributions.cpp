#include "camera_self_calibration/base/distributions.h"

#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

namespace camera_self_calibration {

double chiSquareQuantile(double degrees_of_freedom, double exceed_probability) {
  return 2.0 * boost::math::gamma_q_inv(0.5 * degrees_of_freedom, exceed_probability);
}

double chiSquareExceedance(double value, double degrees_of_freedom) {
  if (std::isnan(value)) return value;
  if (value <= 0.0) return 1.0;
  if (!(degrees_of_freedom > 0.0) || std::isinf(value)) return 0.0;
  return boost::math::gamma_q(0.5 * degrees_of_freedom, 0.5 * value);
}

double fExceedance(double value, double numerator_freedom, double denominator_freedom) {
  if (std::isnan(value)) return value;
  if (value <= 0.0) return 1.0;
  const double x = denominator_freedom / (denominator_freedom + numerator_freedom * value);
  return boost::math::ibeta(0.5 * denominator_freedom, 0.5 * numerator_freedom, x);
}

double chanceBeyond(double value, double sigma, double limit, double freedom) {
  if (!std::isfinite(value)) return 1.0;
  if (!(sigma > 0.0)) return value > limit ? 0.0 : 1.0;
  const double t = (value - limit) / sigma;
  const double both =
      freedom > 0.0 ? fExceedance(t * t, 1.0, freedom) : chiSquareExceedance(t * t, 1.0);
  return t > 0.0 ? 0.5 * both : 1.0 - 0.5 * both;
}

double falseAlarms(double tests, int found, int candidates, double by_chance) {
  if (found <= 0) return tests;
  if (found > candidates) return 0.0;
  // The upper tail of the binomial distribution.
  return tests * boost::math::ibeta(static_cast<double>(found),
                                    static_cast<double>(candidates - found) + 1.0, by_chance);
}

double logIncompleteGamma(double a, double b) {
  return std::lgamma(a) + std::log(boost::math::gamma_p(a, b)) - a * std::log(b);
}

}  // namespace camera_self_calibration
