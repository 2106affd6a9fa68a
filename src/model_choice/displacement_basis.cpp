#include "camera_self_calibration/model_choice/displacement_basis.h"

#include <array>

namespace camera_self_calibration {
namespace {

using Legendre = std::array<double, DisplacementBasis::kDegree + 1>;

Legendre legendre(double x) {
  Legendre values;
  values[0] = 1.0;
  values[1] = x;
  for (int n = 1; n < DisplacementBasis::kDegree; ++n) {
    values[n + 1] = ((2.0 * n + 1.0) * x * values[n] - n * values[n - 1]) / (n + 1.0);
  }
  return values;
}

}  // namespace

DisplacementBasis::Displacements DisplacementBasis::at(const Eigen::Vector2d& pixel) const {
  const Legendre x = legendre(2.0 * pixel.x() / (width_ - 1) - 1.0);
  const Legendre y = legendre(2.0 * pixel.y() / (height_ - 1) - 1.0);
  Displacements all = Displacements::Zero();
  int column = 0;
  for (int degree = 2; degree <= kDegree; ++degree) {
    for (int i = 0; i <= degree; ++i) {
      const double value = x[i] * y[degree - i];
      all(0, column++) = value;
      all(1, column++) = value;
    }
  }
  all(0, column) = y[1];
  return all;
}

}  // namespace camera_self_calibration
