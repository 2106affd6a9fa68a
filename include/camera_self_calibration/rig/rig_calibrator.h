#pragma once

#include <optional>
#include <vector>

#include "camera_self_calibration/rig/across_images.h"
#include "camera_self_calibration/rig/rig_estimate.h"

namespace camera_self_calibration {

struct RigOptions {
  RigSolveOptions solve;
  std::optional<double> baseline_m;  ///< Between the first two cameras [m].
  /// Motions over about this time start the poses: long enough to turn by more than poses are off.
  double motion_interval_s = 1.0;
  int segment_frames = 60;  ///< Keyframes of a segment at most.
  int min_frames = 8;       ///< A stretch of fewer tells nothing that is worth it.
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

  /// Keyframes in the order of time, one view for each camera.
  void add(RigFrame frame) { frames_.push_back(std::move(frame)); }
  int frames() const { return static_cast<int>(frames_.size()); }

  RigEstimate estimate();

 private:
  struct Stretch {
    std::vector<RigFrame> frames;
    RigSegment segment;
  };

  std::string start();
  void cutStretches();
  void seekAcross();
  std::vector<SeenAcross> seekIn(const Stretch& stretch) const;
  bool solve();
  bool solveRoughly();
  std::optional<Rig> underOtherLenses() const;
  void gate();

  RigOptions options_;
  FindAcross across_;
  std::vector<RigFrame> frames_;
  std::vector<std::vector<RigFrame>> stretches_;
  std::vector<RigSegment> segments_;
  Rig rig_;
};

}  // namespace camera_self_calibration
