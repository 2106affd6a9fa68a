#pragma once

#include <limits>
#include <vector>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

/// Intrinsics with what is known of their error.
struct Estimate {
  Intrinsics value;             ///< n_c
  IntrinsicsMatrix covariance;  ///< n_c x n_c
  /// Degrees of freedom that tell how large the covariance is, beside the model of its noise.
  int freedom = 0;
};

/// Sums over estimates of the same intrinsics, each weighted by its information: what is needed to
/// compare groups of them, so that one can be taken out or added at constant cost.
///
/// Estimates may scatter by more than they say: by tau px rms over the image, alike in all
/// directions (covariance `tau^2 U`, see pixelUnit), from bag to bag or from camera to camera. The
/// weights leave that out, the covariance of the mean has it (DerSimonian and Laird 1986).
class EstimateSum {
 public:
  /// `origin`: any value near the estimates; `unit`: pixelUnit() there.
  EstimateSum(const Intrinsics& origin, const IntrinsicsMatrix& unit);

  /// Takes an estimate in, or out again. False, and nothing changed, if its covariance has no
  /// inverse.
  bool add(const Estimate& estimate) { return change(estimate, 1); }
  bool remove(const Estimate& estimate) { return change(estimate, -1); }
  /// Takes in an estimate of which only the covariance of the mean is to know.
  void addInformation(const IntrinsicsMatrix& information);
  EstimateSum& operator+=(const EstimateSum& other);
  EstimateSum& operator-=(const EstimateSum& other);

  int count() const { return count_; }
  int freedom() const { return freedom_; }  ///< Sum of Estimate::freedom.
  Intrinsics mean() const;
  /// Of the mean, where the estimates scatter by `tau_squared` [px^2] beyond what they say.
  IntrinsicsMatrix covariance(double tau_squared = 0.0) const;
  /// The part of it that is due to the scatter: with W the sum of informations W_i
  /// `tau^2 W^-1 (sum W_i U W_i) W^-1`.
  IntrinsicsMatrix scatterCovariance(double tau_squared) const;
  /// Of the estimates about their mean, in their own sigmas.
  double chiSquare() const;
  /// Of chiSquare().
  int scatterFreedom() const;
  /// By how much chiSquare() is expected to grow with tau_squared.
  double scatterSlope() const;

 private:
  bool change(const Estimate& estimate, int sign);
  IntrinsicsMatrix ownCovariance() const;
  void accumulate(const EstimateSum& other, int sign);

  Intrinsics origin_;
  IntrinsicsMatrix unit_;
  int count_ = 0;
  int freedom_ = 0;
  IntrinsicsMatrix information_;
  IntrinsicsMatrix information_unit_information_;
  Intrinsics weighted_;  // sum of information times deviation from the origin
  double square_ = 0.0;
  double unit_trace_ = 0.0;
};

/// The covariance of intrinsics that are off by 1 px rms over the image, alike in all directions.
IntrinsicsMatrix pixelUnit(const Camera& camera);

/// The tau^2 that explains how two groups scatter about their own means [px^2]; 0 where their
/// covariances do.
double scatterBeyond(const EstimateSum& a, const EstimateSum& b);

/// Whether two groups have the same mean.
struct Difference {
  double statistic = 0.0;  ///< Hotelling's, over n_c.
  double p_value = 1.0;    ///< Of so large a statistic if they have.
  double tau_px = 0.0;     ///< Root of scatterBeyond().
};

/// Fisher's F with as many degrees of freedom as the sigmas are known from: the scatter within the
/// groups; where that is no larger than stated, the estimates' own too, and five more, as in
/// Scatter. `most_tau_squared`: more than that is known not to be scatter [px^2].
Difference difference(const EstimateSum& a, const EstimateSum& b,
                      double most_tau_squared = std::numeric_limits<double>::infinity());

/// The tau^2 that explains how estimates differ from the next one, in the median [px^2]: a lens
/// that changes now and then does not count. 0 where their covariances do. `unit` as in
/// EstimateSum.
double successiveScatter(const std::vector<Estimate>& estimates, const IntrinsicsMatrix& unit);

}  // namespace camera_self_calibration
