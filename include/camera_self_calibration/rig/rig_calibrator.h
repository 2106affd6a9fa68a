#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/rig/across_images.h"
#include "camera_self_calibration/rig/rig_estimate.h"
#include "camera_self_calibration/rig/time_offset.h"

namespace camera_self_calibration {

/// How a rig is calibrated.
struct RigOptions {
  RigSolveOptions solve;
  std::optional<double> baseline_m;  ///< Between the first two cameras [m].
  double converged_pixel_rms = 0.0;  ///< As Options::converged_pixel_rms, of the joint intrinsics.
  /// Motions over about this time start the poses: long enough to turn by more than poses are off.
  double motion_interval_s = 1.0;
  int segment_frames = 60;  ///< Keyframes of a segment at most.
  int min_frames = 8;       ///< A segment of fewer tells nothing that is worth it.
  int max_frames = 240;     ///< Kept, with their images: bounds time and memory.
  /// Keyframes of a short segment that is asked by itself where the cameras sit (MountWatch): few,
  /// to tell soon that one was moved, but enough for some motion.
  int mount_frames = 10;
  /// Alarms per hour that a camera was moved while none was; 0: never any alarm.
  double false_alarms_per_hour = 0.1;
  std::vector<std::string> names;  ///< Of the cameras, for sentences; empty: "camera 0", ...
};

/// Calibrates a rig from the synchronised keyframes of its cameras. Each camera has been calibrated
/// for itself, follows its own features and knows its own way; what is new here is where the
/// cameras sit. The motion of each camera starts the poses (handEye), the bundle of all tracks
/// refines them, and with that each camera's landmarks are sought in the images of all others:
/// where views overlap these carry most of what is known. The last solution frees intrinsics, poses
/// of the cameras, the rig's way and all landmarks.
class RigCalibrator {
 public:
  /// `cameras`: their number. `across` may be empty: no landmark is shared.
  RigCalibrator(RigOptions options, int cameras, FindAcross across);

  /// Keyframes in the order of time, one view for each camera. Where there are too many, the
  /// segment of `segment_frames` goes in which the rig turned least; where time jumped back, as in
  /// a bag that is played again, those that are seen again.
  void add(RigFrame frame);
  /// All images, keyframes or not, with poses: whether the cameras' clocks agree. Tracks and images
  /// of `frame` are not kept.
  void observe(const RigFrame& frame);
  /// Keyframes kept.
  int frames() const;
  /// Forgets all that came before the keyframe with this stamp (the newest of several).
  void forgetBefore(std::int64_t stamp_ns);
  /// Forgets the keyframes from one stamp to another.
  void forget(std::int64_t begin_ns, std::int64_t end_ns);

  /// From all keyframes kept, with the intrinsics to start from; more may follow, and then it
  /// begins anew. Where nothing can be said, it is not usable and its sentence says why.
  RigEstimate estimate(std::vector<Camera> cameras);

  /// What the keyframes kept, few in a row, say of the rig, by themselves: their way and landmarks,
  /// and where the cameras sit, solved from `start` with the intrinsics of its cameras held.
  /// `inverse_depth`: RigEstimate's, in the unit of `start`. Nothing if there is no solution.
  std::optional<RigLikelihood> likelihood(const Rig& start, double inverse_depth);

 private:
  void forgetAround(std::int64_t stamp_ns);
  void dropEmpty();
  std::string start();
  void compareClocks(RigEstimate* estimate) const;
  void makeSegments();
  void alignScales();
  void seekAcross();
  std::vector<ExpectedAcross> expectedIn(const RigSegment& segment, int frame, int from,
                                         int to) const;
  std::vector<SeenAcross> seekIn(const RigFrames& frames, const RigSegment& segment) const;
  bool solve();
  bool solveRoughly();
  std::string refine();
  std::optional<Rig> underOtherLenses() const;
  void addShared(RigEvidence* evidence) const;
  void gate();

  RigOptions options_;
  FindAcross across_;
  std::vector<RigFrames> collected_;                 // each of one map of the first camera
  std::vector<RigFrames> used_;                      // those that are long enough
  std::vector<RigSegment> segments_;                 // one for each of them
  std::vector<std::deque<RotationPair>> rotations_;  // of each camera against the first
  Rig rig_;
};

}  // namespace camera_self_calibration
