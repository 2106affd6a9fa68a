#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "camera_self_calibration/fleet/camera_history.h"
#include "camera_self_calibration/pipeline/health.h"
#include "camera_self_calibration/pipeline/learnt_state.h"

namespace camera_self_calibration {

struct MergeOptions {
  int queue_segments = 10;  ///< Of a merged queue.
  int threads = 1;          ///< For its solution, which is the same for any number.
};

/// What the bags of one epoch tell together.
struct EpochSolution {
  /// The merged queue with the records of its bags; null where there is no solution.
  std::shared_ptr<const LearntState> learnt;
  IntrinsicsMatrix covariance;  ///< n_c x n_c.
  HealthVerdict health;
  /// Expected error over the image, all considered [px rms].
  double uncertainty_px = std::numeric_limits<double>::infinity();
  double tau_px = 0.0;                  ///< By how much bags scatter beyond what they say [px rms].
  std::vector<WantedSegment> segments;  ///< Of the merged queue.
  std::vector<IntrinsicsMatrix>
      contributions;  ///< By each bag of the history, in the queue; or empty.
  int missing = 0;    ///< Segments that would have been better, in files that are gone.
};

/// The best segments of an epoch's bags, those with the lowest entropy first, such that none share
/// a moment: what the queue's rule comes to where it is offered the best first. A function of the
/// set of bags alone, whatever way they came.
std::vector<WantedSegment> bestSegments(const CameraHistory& history, int epoch, int count,
                                        const SegmentStore& store, int* missing);

/// Merges the queues of an epoch's bags into one and solves it once.
EpochSolution solveEpoch(const CameraHistory& history, int epoch, const SegmentStore& store,
                         const MergeOptions& options);

}  // namespace camera_self_calibration
