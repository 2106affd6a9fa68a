#pragma once

#include <cstdint>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/queue/agreement.h"

namespace camera_self_calibration {

/// How the lens moved while disjoint segments were seen: Bayes factors against a lens that stayed,
/// and where it is now.
///
/// Segment i shows the intrinsics `x + d_i`, x those now, with its own information divided by a
/// variance v that all segments share: at least 1, and before anything is seen known as well as if
/// five degrees of freedom had scattered by just the stated sigmas (Scatter::moderated). The
/// deviations d_i are Gaussian, their size (in v's root) unknown:
/// - step: the same before segment k, of the focal length or of all intrinsics, and 0 since;
/// - drift: a ramp of the focal length from segment k until now, or a random walk of it;
/// - outlier: one segment alone shows something else, which is not the lens's.
/// x has a flat prior, d and v are integrated in closed form, k and the size by sums; each kind's
/// prior adds up to 1.
///
/// If the lens stays, a factor's expectation is 1, averaged over v, whatever the choice of
/// segments, as long as that does not look at what they say. So it exceeds 1/p with a probability
/// of at most p (Markov's inequality for an e-value: Vovk and Wang, "E-values", 2021), and tests
/// that each spend a share of an allowed rate keep it, however many there are.
struct LensCourse {
  // Natural logarithms of the factors; nothing moved where all segments together tell no lens.
  double step = -kNever;
  double drift = -kNever;
  double outlier = -kNever;
  std::int64_t onset_ns = 0;  ///< Beginning of the first segment after the likeliest step.
  /// The likeliest of the segments that may be wrong: logarithm of its odds against all else, with
  /// what is known beforehand of how often lenses move and segments are wrong. The newest is none
  /// of them: it may be the first after a step.
  double wrong = -kNever;
  std::int64_t wrong_begin_ns = 0;  ///< Its beginning.
  /// Standard deviation of the focal length's relative change over one minute, if it drifts.
  double rate = 0.0;
  Intrinsics now;               ///< n_c, averaged over all kinds and a lens that stayed.
  IntrinsicsMatrix covariance;  ///< Of `now`.

  /// Of a lens that moved, in steps or slowly.
  double moved() const;
  /// Bounds the probability of so much evidence of a lens that moved, were it constant.
  double pValue() const;
  /// One that moved is likelier than one that stayed, and than one bad segment, by this factor.
  bool exceeds(double factor) const;

  static constexpr double kNever = 1e9;
};

/// `segments`, in any order, are of the intrinsics of `camera`; those of other models do not count.
/// `now_ns` is not before any of them.
LensCourse courseOfLens(std::vector<QuadraticLikelihood> segments, const Camera& camera,
                        std::int64_t now_ns);

}  // namespace camera_self_calibration
