#pragma once

#include <Eigen/Core>
#include <vector>

#include "camera_self_calibration/estimation/problem.h"
#include "camera_self_calibration/model_choice/displacement_basis.h"

namespace camera_self_calibration {

/// As Marginal, spurious information from noise in the depths included, of a lens whose pixels are
/// displaced beyond its model: the unknowns are its n_c intrinsics and, at first zero, the
/// coefficients of DisplacementBasis [px]. Where the intrinsics change by c and the coefficients by
/// e, the ray of pixel u projects to `u + J_c c + Phi(u) e`, and the pixel of a reference has the
/// ray that projects there.
struct DisplacementMarginal {
  /// Reduced system, poses and landmarks eliminated; n_c + kCount unknowns.
  struct System {
    Eigen::MatrixXd information;
    Eigen::VectorXd gradient;
  };
  std::vector<System> shares;    ///< Of each block.
  System sum;                    ///< Of all.
  Eigen::MatrixXd track_scores;  ///< As Marginal::track_scores.
  double cost = 0.0;             ///< Robust, of the observations that can be predicted.
  int observations = 0;          ///< Those, each of two coordinates.
  int variables = 0;             ///< Free ones, without the coefficients, which stay at zero.

  /// Degrees of freedom of the residuals.
  int freedom() const;
  /// Cost per degree of freedom: the square of Marginal::residualScale.
  double residualVariance() const;
};

/// One fresh undamped linearisation at the problem's present state.
DisplacementMarginal displacementMarginal(const Problem& problem, double huber, int threads);

}  // namespace camera_self_calibration
