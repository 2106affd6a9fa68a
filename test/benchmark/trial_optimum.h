#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/map/segment.h"
#include "camera_self_calibration/simulation/feature_tracks.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

/// The solution that an estimate should have found from some stretches of the trajectory: the one
/// that is found when everything starts at the truth.
class TrialOptimum {
 public:
  explicit TrialOptimum(const Camera& truth) : truth_(truth) {}

  /// `frame` with the tracks that start in it.
  void addKeyframe(const TrackedFrame& frame, const FeatureTracks& tracks);

  /// All keyframes between these stamps, inclusive.
  struct Span {
    std::int64_t begin_ns = std::numeric_limits<std::int64_t>::min();
    std::int64_t end_ns = std::numeric_limits<std::int64_t>::max();
  };
  struct Result {
    /// With the estimate's intrinsics held and the rest solved, over the cost at the optimum, less
    /// 1; infinite where it cannot be computed.
    double excess_cost = 0.0;
    double uncertainty_rms = 0.0;  ///< At the optimum [px].
  };
  /// Of the observations in these stretches, which share nothing but the intrinsics.
  Result compare(const Camera& estimate, const std::vector<Span>& spans) const;

 private:
  Segment atTruth(const Span& span) const;

  Camera truth_;
  std::vector<TrackedFrame> frames_;
  std::vector<Rigid3> poses_;                                 // of frames_, true
  std::unordered_map<std::int64_t, Eigen::Vector3d> points_;  // by track id, true
};

}  // namespace camera_self_calibration
