#pragma once

#include <optional>
#include <vector>

#include "camera_self_calibration/estimation/problem.h"

namespace camera_self_calibration {

/// What one block adds to the reduced system of the intrinsics, all noise included.
struct BlockShare {
  IntrinsicsMatrix information;  ///< n_c x n_c
  Intrinsics gradient;           ///< n_c
};

/// The information of a problem's observations about the intrinsics, at its present state.
struct Marginal {
  /// Inverse of the intrinsics' block of (J^T J)^-1 (eq. 4): the reduced system that is left when
  /// landmarks and poses are eliminated, undamped. n_c x n_c.
  IntrinsicsMatrix information;
  /// The same with the spurious part from noise in the inverse depths, which
  /// InverseDepthNoise::kDiscounted leaves out of all else here.
  IntrinsicsMatrix whole_information;
  std::vector<BlockShare> shares;  ///< Of each block, in `whole_information`.
  /// `sum s s^T` over tracks (LinearSegment::trackScores), with the loss of degrees of freedom made
  /// up for: as `information` where residuals are independent, larger where they are correlated.
  IntrinsicsMatrix track_scores;
  /// What is left of the gradient of the intrinsics when the rest is eliminated: 0 at an optimum.
  Intrinsics gradient;
  double cost = 0.0;     ///< Robust, of all observations.
  int observations = 0;  ///< Each of two coordinates.
  int variables = 0;     ///< Free ones, the intrinsics among them.

  /// Residual scale: sqrt of cost per degree of freedom, 1 if the sigmas are right.
  double residualScale() const;

  /// Mean variance of the intrinsics, correlation along tracks considered, over that of the inverse
  /// information: trace(information^-1 track_scores) / n_c; 1 where it cannot be computed.
  double designEffect() const;

  /// By how much the sigmas have to grow to explain the residuals, and what is correlated along
  /// tracks: the root of the larger of the squared residual scale and the design effect; at
  /// least 1.
  double sigmaScale() const;

  /// How far the intrinsics are from the optimum, to first order: length of the next Gauss-Newton
  /// step b, `sqrt(b^T I b)`, in their own standard deviations; infinite where I is singular.
  double remainingStep() const;

  /// `I^-1 M I^-1` with I the information and M the track scores: the covariance of the estimate
  /// whatever the correlation along a track (cluster-robust: Liang and Zeger 1986); in no direction
  /// smaller than I^-1. Nothing where I is singular (as covarianceFromInformation).
  std::optional<IntrinsicsMatrix> robustCovariance() const;
};

/// The covariance `L F L^T`, where it is larger than `L L^T`: F (symmetric, n x n) counts in the
/// directions in which it is above the identity. `root` is L, a Cholesky factor.
Eigen::MatrixXd widened(const Eigen::MatrixXd& root, const Eigen::MatrixXd& factor);

/// Whether spurious information from noise in the inverse depths counts (see
/// inverse_depth_noise.h).
enum class InverseDepthNoise {
  kCounts,     ///< All of it: eqs. 4 and 5 as they are.
  kDiscounted  ///< As little as is honest: no change where parallax determines the depths well.
};

/// One fresh undamped linearisation (eqs. 4, 5).
Marginal marginalize(const Problem& problem, double huber, int threads = 1,
                     InverseDepthNoise noise = InverseDepthNoise::kCounts);

/// Eigenvalues of an information matrix scaled to a unit diagonal, in increasing order: the
/// smallest shows how well conditioned the estimate is, whatever the parameters' units.
Intrinsics scaledEigenvalues(const IntrinsicsMatrix& information);

/// Scaled eigenvalue below which a direction of the intrinsics counts as not observed at all.
inline constexpr double kUnobservedEigenvalue = 1e-7;

/// Inverse of an information matrix; nothing where its smallest scaled eigenvalue is below
/// `rank_tolerance`.
std::optional<IntrinsicsMatrix> covarianceFromInformation(const IntrinsicsMatrix& information,
                                                          double rank_tolerance = 1e-10);

}  // namespace camera_self_calibration
