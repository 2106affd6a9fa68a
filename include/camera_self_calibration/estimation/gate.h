#pragma once

#include <cstdint>
#include <vector>

#include "camera_self_calibration/estimation/problem.h"

namespace camera_self_calibration {

/// Which tracks do not fit: per landmark, the sum of the squared whitened residuals against twice
/// the chi-square quantile of its degrees of freedom (2 per observation, less its own parameters;
/// twice, because errors along a track are correlated), and every single residual against that of
/// 2, at a hundredth of the probability; sigmas multiplied by the block's scale. Landmarks that
/// cannot be predicted do not fit either. Returns indices into the segment's landmarks.
std::vector<int> misfits(const SegmentBlock& block, const Camera& camera,
                         double exceed_probability = 1e-3);

/// The `count` landmarks that fit worst, by the mean squared whitened residual per degree of
/// freedom; worst first. Indices into the segment's landmarks.
std::vector<int> worstTracks(const SegmentBlock& block, const Camera& camera, int count);

/// A residual is gross beyond so many sigmas, scaled to the residuals of the others, and so great a
/// share of the image's longer side: the track does not belong to a rigid scene, or left its
/// feature.
inline constexpr double kGrossSigmas = 5.0;
inline constexpr double kGrossShare = 1.5 / 640;

/// Landmarks with a residual that is gross: beyond `sigmas` scaled sigmas and beyond `min_px`, or
/// that cannot be predicted.
std::vector<int> grossMisfits(const SegmentBlock& block, const Camera& camera, double sigmas,
                              double min_px);

/// The error per axis [px] that the observations' own sigmas leave out, such as that of the lens
/// model or of blur: the f for which the median of the squared residuals, each over sigma^2 + f^2,
/// is what it should be, the loss of degrees of freedom accounted for. 0 where the sigmas suffice.
double unexplainedSigma(const SegmentBlock& block, const Camera& camera);

/// What gateSegment() did.
struct GateResult {
  double unexplained_sigma = 0.0;  ///< That it added, in quadrature [px].
  std::vector<std::int64_t> removed_tracks;
};

/// Between two solutions of a segment: adds what the sigmas leave out (unexplainedSigma) to those
/// of all its observations, so that a common misfit empties no segment, and then removes the tracks
/// that do not fit (misfits). `fixed_landmark` of the block no longer holds.
GateResult gateSegment(const SegmentBlock& block, const Camera& camera);

/// Robust residual scale of a segment's fit: median of the squared whitened residuals over its
/// expectation for right sigmas, square-rooted; with the loss of degrees of freedom accounted for.
double medianResidualScale(const SegmentBlock& block, const Camera& camera);

/// The same within [1, 1000], for a state that is far from the solution, where all residuals are
/// large: with sigmas scaled by it the robust loss still tells outliers from the rest. Bounded,
/// since where nothing can be predicted there is no residual to follow.
double provisionalScale(const SegmentBlock& block, const Camera& camera);

}  // namespace camera_self_calibration
