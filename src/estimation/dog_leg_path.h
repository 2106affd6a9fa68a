#pragma once

#include <Eigen/Core>

namespace camera_self_calibration {

/// The point of the dog-leg path (to the Cauchy step, then to the Gauss-Newton step) on the border
/// of a trust region that is a ball of this radius in the variables times `scale`. The Gauss-Newton
/// step lies outside of it.
Eigen::VectorXd dogLegPoint(const Eigen::VectorXd& newton, const Eigen::VectorXd& cauchy,
                            const Eigen::VectorXd& scale, double radius);

}  // namespace camera_self_calibration
