#pragma once

#include <cstdint>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/reference/whole_trajectory.h"

namespace camera_self_calibration {

/// The batch solution of everything seen up to a keyframe.
struct BatchEstimate {
  std::int64_t stamp_ns = 0;  ///< Of the newest keyframe.
  int keyframes = 0;
  int observations = 0;  ///< That passed the gates.
  Camera camera;
  /// Cluster-robust along tracks (Liang and Zeger 1986), as the queue's; empty if singular.
  IntrinsicsMatrix covariance;
  PixelError uncertainty;  ///< [px]; infinite without a covariance.
  double entropy = 0.0;    ///< Normalised as the queue's [nats]; infinite without a covariance.
  double unexplained_sigma = 0.0;  ///< Error per axis that was added to the tracker's sigmas [px].
  bool converged = false;
};

/// The whole-trajectory batch that the paper compares the queue with (section III): the queue's
/// tracks and gates, but every keyframe of the run, solved with Ceres from the state of the last
/// solution.
class TrajectoryBatch {
 public:
  /// The window that a keyframe offers to the queue, once each keyframe.
  void add(const Segment& window) { trajectory_.add(window); }

  /// Frees all pixels of a rolling shutter of this time between rows [s].
  void setLineDelay(double line_delay_s, int image_height) {
    trajectory_.setLineDelay(line_delay_s, image_height);
  }

  int keyframes() const { return trajectory_.keyframes(); }

  /// Solves for all that was added, starting from `start` for the intrinsics. As for a segment of
  /// the queue: what the tracker's sigmas leave unexplained is added to them and tracks that do not
  /// fit are left out, then it is solved again.
  BatchEstimate solve(const Camera& start, int threads = 1);

 private:
  WholeTrajectory trajectory_;
};

}  // namespace camera_self_calibration
