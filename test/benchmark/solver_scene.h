#pragma once

#include <vector>

#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/problem.h"
#include "camera_self_calibration/reference/batch.h"
#include "camera_self_calibration/simulation/segment_maker.h"

namespace camera_self_calibration {

/// Problems of the sizes that a running system solves, from starts a little off the solution. The
/// same for this package's solver and for Ceres.
class SolverScene {
 public:
  enum class Kind {
    kSlidingWindow,  ///< 10 active keyframes conditioned on 10 more; intrinsics held.
    kCandidate,      ///< 10 keyframes and the intrinsics.
    kQueue,          ///< 10 such segments.
    kBatch           ///< One segment of many keyframes and the intrinsics.
  };

  /// `keyframes` counts for kBatch alone.
  explicit SolverScene(Kind kind, int keyframes = 0);

  /// Puts everything back to the start; not part of what is timed.
  void restart();

  Problem problem();
  std::vector<BatchSegment> batch();
  Camera& camera() { return camera_; }
  const Segment& firstSegment() const { return segments_.front(); }
  bool estimatesIntrinsics() const { return kind_ != Kind::kSlidingWindow; }
  int observations() const;

 private:
  Kind kind_;
  Camera start_camera_;
  std::vector<Segment> start_segments_;
  std::vector<int> fixed_landmarks_;
  Camera camera_;
  std::vector<Segment> segments_;
};

}  // namespace camera_self_calibration
