#pragma once

#include <optional>

#include "camera_self_calibration/estimation/problem.h"

namespace camera_self_calibration {

/// What a problem's observations tell of the intrinsics, at its present state.
struct Marginal {
  /// Inverse of the intrinsics' block of (J^T J)^-1 (eq. 4): the reduced system that is left when
  /// landmarks and poses are eliminated, undamped. n_c x n_c.
  IntrinsicsMatrix information;
  double cost = 0.0;     ///< Robust, of all observations.
  int observations = 0;  ///< Each of two coordinates.
  int variables = 0;     ///< Free ones, the intrinsics among them.

  /// Residual scale: sqrt of cost per degree of freedom, 1 if the sigmas are right.
  double residualScale() const;
};

/// One fresh undamped linearisation (eqs. 4, 5).
Marginal marginalize(const Problem& problem, double huber, int threads = 1);

/// Eigenvalues of an information matrix scaled to a unit diagonal, in increasing order: the smallest
/// tells how well conditioned the estimate is, whatever the parameters' units.
Intrinsics scaledEigenvalues(const IntrinsicsMatrix& information);

/// Inverse of an information matrix; nothing where its smallest scaled eigenvalue is below
/// `rank_tolerance`.
std::optional<IntrinsicsMatrix> covarianceFromInformation(const IntrinsicsMatrix& information,
                                                          double rank_tolerance = 1e-10);

}  // namespace camera_self_calibration
