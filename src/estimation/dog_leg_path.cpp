#include "dog_leg_path.h"

#include <algorithm>
#include <cmath>

namespace camera_self_calibration {

Eigen::VectorXd dogLegPoint(const Eigen::VectorXd& newton, const Eigen::VectorXd& cauchy,
                            const Eigen::VectorXd& scale, double radius) {
  const Eigen::VectorXd start = cauchy.cwiseProduct(scale);
  const double start_norm = start.norm();
  if (start_norm >= radius) return radius / start_norm * cauchy;
  const Eigen::VectorXd leg = newton.cwiseProduct(scale) - start;
  const double a = leg.squaredNorm();
  const double b = start.dot(leg);
  const double c = radius * radius - start_norm * start_norm;
  const double t = c / (b + std::sqrt(std::max(0.0, b * b + a * c)));
  return cauchy + t * (newton - cauchy);
}

}  // namespace camera_self_calibration
