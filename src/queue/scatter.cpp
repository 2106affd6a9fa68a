#include "camera_self_calibration/queue/scatter.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/base/distributions.h"

namespace camera_self_calibration {
namespace {

// Scatter that is more likely than this is chance.
constexpr double kByChance = 0.05;

}  // namespace

double Scatter::birgeRatio() const {
  return freedom > 0 ? std::sqrt(std::max(1.0, chi_square / freedom)) : 1.0;
}

Scatter Scatter::moderated() const { return {chi_square + kPriorFreedom, freedom + kPriorFreedom}; }

int Scatter::birgeFreedom() const {
  return freedom > 0 && chiSquareExceedance(chi_square, freedom) < kByChance ? freedom : 0;
}

ScatterVariance Scatter::variance() const {
  return birgeFreedom() > 0 ? cautiousVariance() : ScatterVariance{birgeRatio() * birgeRatio(), 0};
}

ScatterVariance Scatter::cautiousVariance() const {
  if (freedom == 0) return {};
  const Scatter more = moderated();
  return {more.birgeRatio() * more.birgeRatio(), more.freedom};
}

double ScatterVariance::exceedance(double chi_square, double degrees_of_freedom) const {
  const double ratio = chi_square / factor;
  return freedom > 0 ? fExceedance(ratio / degrees_of_freedom, degrees_of_freedom, freedom)
                     : chiSquareExceedance(ratio, degrees_of_freedom);
}

}  // namespace camera_self_calibration
