#pragma once

namespace camera_self_calibration {

/// Segments that disagree by more than this factor of their uncertainties are not describing one
/// camera, or one of them sits in a wrong minimum.
constexpr double kMaxBirgeRatio = 5.0;

/// A variance that differences are held against, in units of what their sigmas say.
struct ScatterVariance {
  double factor = 1.0;
  int freedom = 0;  ///< Degrees of freedom that it was estimated from; 0: it is known.

  /// Probability that chance exceeds `chi_square`, a sum of squares in sigmas, of so many degrees
  /// of freedom: an F test where the variance was estimated.
  double exceedance(double chi_square, double degrees_of_freedom) const;
};

/// How far estimates of the same quantities are apart, each with its own uncertainty.
struct Scatter {
  double chi_square = 0.0;  ///< Sum of squares, in their own sigmas, around their best compromise.
  int freedom = 0;          ///< Degrees of freedom of chi_square; 0: a single estimate.

  /// The factor by which their sigmas are too small: sqrt of chi-square per degree of freedom
  /// (Birge 1932), at least 1.
  double birgeRatio() const;

  /// Degrees of freedom that the stated sigmas count for, beside what scatters.
  static constexpr int kPriorFreedom = 5;

  /// The same with the sigmas themselves for a witness: as if kPriorFreedom more degrees of freedom
  /// had scattered by just those. What two segments alone scatter could be of any size by chance.
  Scatter moderated() const;

  /// Degrees of freedom from which birgeRatio() is known; 0 where so much happens by chance: the
  /// sigmas are right, and birgeRatio() is no estimate of a variance.
  int birgeFreedom() const;

  /// For tests against the sigmas.
  ScatterVariance variance() const;

  /// The same where that a few segments scatter by no more than their sigmas is not to prove that
  /// the next one will not.
  ScatterVariance cautiousVariance() const;
};

}  // namespace camera_self_calibration
