#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "camera_self_calibration/base/noisy_length.h"
#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/image_weights.h"

namespace camera_self_calibration {

/// How far a known calibration is from an estimate of the lens, over the parts of the image that
/// count, a rotation of the camera removed; and what the estimate's noise has to do with it.
struct EstimateDistance {
  struct Point {
    Eigen::Vector2d pixel;   ///< Of the estimate.
    Eigen::Vector2d offset;  ///< Where the calibration sees the same ray, less `pixel` [px].
    double weight = 1.0;
  };

  NoisyLength offset;  ///< Over what counts [px rms].
  /// The rotation that was removed, across the optical axis: the axes of the two are so far apart.
  double axis_deg = 0.0;
  double axis_sigma_deg = std::numeric_limits<double>::infinity();
  double refused = 0.0;  ///< Share of what counts whose rays the calibration cannot project.
  std::vector<Point> points;
};

/// `covariance` is that of the estimate, n_c x n_c. With G the metric of the weights (as
/// pixelMetric), C the covariance and e the offsets, `found^2 = mean e^2` is on average the squared
/// distance from the true lens and `noise^2 = trace(G C)` (NoisyLength); to first order its
/// variance is `4 g^T C g + 2 trace((G C)^2)` with `g = mean A'^T e`. Rays that cannot be projected
/// are left out. Infinite where none can, or where nothing is known of the estimate.
EstimateDistance distanceFromEstimate(const Camera& estimate, const IntrinsicsMatrix& covariance,
                                      const Camera& calibration, const ImageWeights& weights);

}  // namespace camera_self_calibration
