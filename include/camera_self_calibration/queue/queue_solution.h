#pragma once

#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/queue/line_delay.h"
#include "camera_self_calibration/queue/scatter.h"

namespace camera_self_calibration {

/// Where a lens is that moved while the segments were seen, as one does that warms up
/// (courseOfLens).
struct LensDrift {
  bool significant = false;  ///< Else what follows is of no use.
  bool told = false;         ///< Said as surely as a change is, at the newest disjoint segment.
  /// Standard deviation of the focal length's relative change over one minute.
  double rate = 0.0;
  Intrinsics offset;            ///< Of the lens now from the joint estimate, n_c.
  IntrinsicsMatrix covariance;  ///< Of the lens now, n_c x n_c.
};

/// The joint estimate of the intrinsics over all segments of the queue: eq. 3 over all segments,
/// which share nothing else; each in its own gauge, weighted by its own residual scale.
struct QueueSolution {
  bool usable = false;  ///< Valid intrinsics with a covariance.
  Camera camera;
  /// Sum of the segments' marginals at the joint optimum, divided by the square of
  /// scatter.birgeRatio().
  IntrinsicsMatrix information;
  std::vector<BlockShare> shares;  ///< The segments' marginals, in the queue's order.
  /// The inverse of the information without the spurious part from noise in the inverse depths
  /// (InverseDepthNoise::kDiscounted), made larger where residuals are correlated along tracks
  /// (Marginal::robustCovariance); empty where that is singular.
  IntrinsicsMatrix covariance;
  /// How far the segments disagree. Each one's share of the chi-square is twice what its cost rises
  /// from its own optimum to the joint one, at most what its own information says it should. It
  /// tells of errors that last longer than a segment's residuals can show.
  Scatter scatter;
  int iterations = 0;
  LensDrift drift;  ///< What all of the above, where the lens is constant, leaves out.

  /// The lens now, and its covariance: the above, where nothing drifts.
  Camera present() const;
  IntrinsicsMatrix presentCovariance() const;

  /// The line delay is one of the unknowns: makes the covariance larger by what is left open where
  /// it is `doubt_s` off.
  void addUncertaintyOf(const LineDelayEstimate& line_delay, double doubt_s);
};

}  // namespace camera_self_calibration
