#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

/// Eq. (2) for an anchored landmark, whitened: r = (z - P(x, x_c)) / sigma with
/// x = R_i^T (R_r d + rho (t_r - t_i)), d = P^-1(reference_pixel, x_c).
/// Parameter blocks: q_i (x y z w), t_i, q_r, t_r, rho, x_c. A point or a reference pixel outside
/// the camera's domain gives zero residual and derivatives; intrinsics that are not valid make the
/// evaluation fail, so that Ceres refuses the step.
class AnchoredResidual : public ceres::CostFunction {
 public:
  /// `camera` gives the model; its parameters are replaced by the last block.
  AnchoredResidual(const Camera& camera, const Eigen::Vector2d& reference_pixel,
                   const Eigen::Vector2d& pixel, double sigma);
  bool Evaluate(double const* const* parameters, double* residual,
                double** jacobians) const override;

 private:
  Camera camera_;
  Eigen::Vector2d reference_pixel_;
  Eigen::Vector2d pixel_;
  double sigma_;
};

/// As AnchoredResidual for a landmark whose unit bearing d is a parameter.
/// Parameter blocks: q_i (x y z w), t_i, q_r, t_r, rho, d, x_c.
class InheritedResidual : public ceres::CostFunction {
 public:
  InheritedResidual(const Camera& camera, const Eigen::Vector2d& pixel, double sigma);
  bool Evaluate(double const* const* parameters, double* residual,
                double** jacobians) const override;

 private:
  Camera camera_;
  Eigen::Vector2d pixel_;
  double sigma_;
};

/// The observation of such a landmark in its reference keyframe: r = (z - P(d, x_c)) / sigma.
/// Parameter blocks: d, x_c.
class FirstObservationResidual : public ceres::CostFunction {
 public:
  FirstObservationResidual(const Camera& camera, const Eigen::Vector2d& pixel, double sigma);
  bool Evaluate(double const* const* parameters, double* residual,
                double** jacobians) const override;

 private:
  Camera camera_;
  Eigen::Vector2d pixel_;
  double sigma_;
};

}  // namespace camera_self_calibration
