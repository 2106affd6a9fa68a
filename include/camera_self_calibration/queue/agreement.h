#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/map/segment.h"
#include "camera_self_calibration/queue/scatter.h"
#include "camera_self_calibration/queue/segment_queue.h"

namespace camera_self_calibration {

/// What a segment of video says of the intrinsics: the log-likelihood as a quadratic at `point`,
/// poses and landmarks at their best for it. n_c values each.
struct QuadraticLikelihood {
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
  Intrinsics point;
  Intrinsics gradient;           ///< Reduced `J^T r`.
  IntrinsicsMatrix information;  ///< Reduced `J^T J`.

  /// The gradient at other intrinsics.
  Intrinsics gradientAt(const Intrinsics& other) const {
    return gradient - information * (other - point);
  }
};

/// `g^T I^+ g`: how far the estimate of which these are gradient and information is from where they
/// were taken, in its own sigmas, squared. Directions that it does not determine do not count.
double squaredDistance(const Intrinsics& gradient, const IntrinsicsMatrix& information);

/// What a solved candidate says, at its own optimum, where the gradient vanishes.
QuadraticLikelihood ownLikelihood(const Candidate& candidate);

/// Solves poses and landmarks of a copy of the segment with the intrinsics held, sigmas multiplied
/// by `sigma_scale`, and linearises there. Nothing if there is no solution.
std::optional<QuadraticLikelihood> likelihoodAt(const Camera& camera, const Segment& segment,
                                                double sigma_scale);

/// Estimated intrinsics that others are compared with.
struct Reference {
  Camera camera;
  IntrinsicsMatrix information;  ///< n_c x n_c.
  /// How far segments are known to disagree: the sigmas of what is compared are multiplied by its
  /// birgeRatio().
  Scatter scatter;
  /// p-values allow for how roughly few segments show that, also where they agree by chance.
  bool cautious = false;
};

/// The queue's estimate without the segments that share a moment with [begin, end], by subtracting
/// what they said at the joint optimum; its scatter is that of the segments that are left, or of
/// all where a single one is. Nothing if the rest does not determine the intrinsics.
std::optional<Reference> referenceWithout(std::int64_t begin_ns, std::int64_t end_ns,
                                          const SegmentQueue& queue);

/// Hotelling's statistic for two estimates of the same intrinsics that share no data (Hotelling
/// 1931).
struct Agreement {
  double statistic = 0.0;  ///< `T^2 = d^T (Sigma_reference + Sigma_other)^-1 d`.
  double p_value = 1.0;    ///< Probability of so large a value if the intrinsics are the same.
};

/// Whether segments that share no data, taken together, agree with the reference. Directions that
/// they do not determine do not count.
Agreement agreement(const std::vector<QuadraticLikelihood>& likelihoods,
                    const Reference& reference);

/// The intrinsics that the likelihoods and the reference, taken as independent, agree on best; n_c
/// values.
Intrinsics compromise(const std::vector<QuadraticLikelihood>& likelihoods,
                      const Reference& reference);

/// The camera with other estimated intrinsics, n_c values or fewer.
Camera withEstimated(const Camera& camera, const Intrinsics& values);

/// p-value of a statistic with n_c degrees of freedom: chi-square; where the reference's Birge
/// ratio is more than chance, or the reference is cautious, F with the variance moderated towards
/// the sigmas as they are (as if five more degrees of freedom had scattered by just those).
double pValue(double statistic, const Reference& reference);

}  // namespace camera_self_calibration
