#pragma once

#include <ceres/problem.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace camera_self_calibration {

/// What a Ceres problem of residual blocks with two rows each tells of some of its variables.
struct SharedMarginal {
  Eigen::MatrixXd covariance;  ///< Their block of (J^T J)^-1 (eq. 4).
  /// `sum psi psi^T` over clusters, psi a cluster's share of these variables' error: with Y their
  /// columns of (J^T J)^-1 and r the residuals, `psi = sum Y^T J^T r`. As `covariance` in
  /// expectation where residuals are independent, larger where they are correlated in a cluster.
  Eigen::MatrixXd influence;
  double cost = 0.0;
  int observations = 0;  ///< Residual blocks.
  int variables = 0;     ///< Free ones.

  /// The factor that makes up for the degrees of freedom that the variables take; 1 where none are
  /// left.
  double freedomFactor() const;
};

/// At the problem's present state, of the last `count` tangent coordinates of `blocks`, which are
/// all its free blocks. `clusters` has one entry for each residual block, in the order in which
/// they were added: 0, 1, ... Nothing where these variables are not observed.
std::optional<SharedMarginal> sharedMarginal(ceres::Problem* problem,
                                             const std::vector<double*>& blocks, int count,
                                             const std::vector<int>& clusters, int threads = 1);

/// What such a problem says of the same variables, all others at their best for each value of them.
/// Other than a covariance it may leave some of them open.
struct SharedInformation {
  Eigen::MatrixXd information;  ///< Reduced `J^T J`.
  Eigen::VectorXd gradient;     ///< Reduced `-J^T r`: where it vanishes is the optimum.
  /// `sum s s^T` over clusters, s a cluster's share of `gradient`. As `information` in expectation
  /// where residuals are independent, larger where they are correlated in a cluster.
  Eigen::MatrixXd scatter;
  double cost = 0.0;
  int observations = 0;  ///< Residual blocks.
  int variables = 0;     ///< Free ones.

  /// As SharedMarginal::freedomFactor.
  double freedomFactor() const;
  /// The factor by which variances are larger than `information` says: by the size of residuals or,
  /// if that is more, by their correlation along clusters; at least 1.
  double varianceFactor() const;
};

/// As sharedMarginal. Nothing where the other variables cannot be eliminated.
std::optional<SharedInformation> sharedInformation(ceres::Problem* problem,
                                                   const std::vector<double*>& blocks, int count,
                                                   const std::vector<int>& clusters,
                                                   int threads = 1);

}  // namespace camera_self_calibration
