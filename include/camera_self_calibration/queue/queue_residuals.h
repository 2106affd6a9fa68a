#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "camera_self_calibration/queue/candidate_window.h"

namespace camera_self_calibration {

/// An observation that a calibration rests on.
struct QueueResidual {
  std::int64_t sequence = 0;                           ///< Of its segment.
  std::int64_t stamp_ns = 0;                           ///< Of its keyframe.
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();     ///< Measured.
  Eigen::Vector2d residual = Eigen::Vector2d::Zero();  ///< z - W (eq. 2) [px].
  double sigma = 1.0;  ///< Per axis: the tracker's, with what that leaves unexplained [px].
  /// Expected square of residual / sigma, an axis. It is below 1 because the landmark and the
  /// segment's poses are fitted to the same observations: 1 - parameters / measurements.
  double expected_square = 1.0;
};

/// The residuals of all segments of a queue under the estimate `camera`; observations that cannot
/// be predicted are left out.
std::vector<QueueResidual> queueResiduals(const std::vector<Candidate>& queue,
                                          const Camera& camera);

}  // namespace camera_self_calibration
