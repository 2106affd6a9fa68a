#pragma once

#include <Eigen/Core>

#include "camera_self_calibration/estimation/linear_segment.h"
#include "camera_self_calibration/estimation/problem.h"

namespace camera_self_calibration {

/// Spurious information about the translations from noise in the inverse depths: three columns per
/// free keyframe. A translation moves a point in proportion to its inverse depth rho, so that the
/// point contributes rho^2 D^T D to it, D the derivative of the pixel at inverse depth 1. Of an
/// estimated rho^2 the share `sigma^2 / (sigma^2 + rho^2)` is noise, sigma the deviation of rho
/// with poses and intrinsics held. All landmarks count, a fixed one too, and the scale of all
/// positions does not: what follows does not depend on the choice of gauge.
Eigen::MatrixXd inverseDepthNoise(const SegmentBlock& block, const LinearSegment& linear);

/// The information of a block about the intrinsics when poses and landmarks are eliminated.
struct ReducedInformation {
  IntrinsicsMatrix information;
  IntrinsicsMatrix track_scores;  ///< As LinearSegment::trackScores.
  Intrinsics gradient;
};

/// `linear`, the block's system, linearised for a marginal and eliminated undamped, as it is.
ReducedInformation reducedInformation(const LinearSegment& linear);

/// The same without the spurious information of inverseDepthNoise(). Were the inverse depths known,
/// the Hessian would be A = H - N, N the noise; the score's variance is H, and so the covariance is
/// `A^-1 H A^-1`. In the directions in which N takes nearly all, A stays at a small share of H: the
/// result is positive semidefinite and in no direction more than `linear` says. Score and gradient
/// follow, so that design effect and Gauss-Newton step stay the same.
ReducedInformation discountedInformation(const SegmentBlock& block, const LinearSegment& linear);

}  // namespace camera_self_calibration
