#pragma once

#include <optional>
#include <vector>

#include "camera_self_calibration/rig/across_images.h"
#include "camera_self_calibration/rig/rig_estimate.h"
#include "camera_self_calibration/rig/time_offset.h"

namespace camera_self_calibration {

/// How a rig is calibrated.
struct RigOptions {
  RigSolveOptions solve;
  std::optional<double> baseline_m;  ///< Between the first two cameras [m].
  /// Motions over about this time start the poses: long enough to turn by more than poses are off.
  double motion_interval_s = 1.0;
  int segment_frames = 60;  ///< Keyframes of a segment at most.
  int min_frames = 8;       ///< A stretch of fewer tells nothing that is worth it.
  int max_frames = 240;     ///< Kept, with their images: bounds time and memory.
};

/// Calibrates a rig from the synchronised keyframes of its cameras. Each camera has been calibrated
/// for itself, follows its own features and knows its own way; what is new here is where the
/// cameras sit. The motion of each camera starts the poses (handEye), the bundle of all tracks
/// refines them, and with that each camera's landmarks are sought in the images of all others:
/// where views overlap these carry most of what is known. The last solution frees intrinsics, poses
/// of the cameras, the rig's way and all landmarks.
class RigCalibrator {
 public:
  /// `cameras`: the intrinsics to start from. `across` may be empty: no landmark is shared.
  RigCalibrator(RigOptions options, std::vector<Camera> cameras, FindAcross across);

  /// Keyframes in the order of time, one view for each camera. Where there are too many, the
  /// stretch of `segment_frames` goes in which the rig turned least.
  void add(RigFrame frame);
  /// All images, keyframes or not, with poses: whether the cameras' clocks agree. Tracks and images
  /// of `frame` are not kept.
  void observe(const RigFrame& frame);
  /// Keyframes kept.
  int frames() const;

  /// From all keyframes kept; more may follow, and then it begins anew. Where nothing can be said,
  /// it is not usable and its sentence says why.
  RigEstimate estimate();

 private:
  using Stretch = std::vector<RigFrame>;

  std::string start();
  void judgeClocks(RigEstimate* estimate) const;
  void makeSegments();
  void alignScales();
  void seekAcross();
  std::vector<ExpectedAcross> expectedIn(const RigSegment& segment, int frame, int from,
                                         int to) const;
  std::vector<SeenAcross> seekIn(const Stretch& stretch, const RigSegment& segment) const;
  bool solve();
  bool solveRoughly();
  std::optional<Rig> underOtherLenses() const;
  void gate();

  RigOptions options_;
  FindAcross across_;
  std::vector<Stretch> stretches_;                    // each of one map of the first camera
  std::vector<Stretch> used_;                         // those that are long enough
  std::vector<RigSegment> segments_;                  // one for each of them
  std::vector<std::vector<RotationPair>> rotations_;  // of each camera against the first
  Rig rig_;
};

}  // namespace camera_self_calibration
