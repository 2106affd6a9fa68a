#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "camera_self_calibration/pipeline/results.h"

namespace camera_self_calibration {

/// What became of a run in which tracking was made hard or impossible for a while.
struct LossOutcome {
  int lost = 0;          ///< Events.
  int relocalized = 0;   ///< Events.
  int changes = 0;       ///< Events.
  double blind_s = 0.0;  ///< From the first usable image until the camera is tracked for good.
  double relocalized_s = 0.0;  ///< From the first usable image to the last RELOCALIZED.
  /// kTeleport: the same while in the other room.
  int relocalized_elsewhere = 0;
  double blind_elsewhere_s = 0.0;
  /// kWhipPan: of what the first usable image shows, the share that was in an image before.
  double known_share = 0.0;
  std::uint64_t map_id = 0;  ///< In the end; it was 0 before.
  /// Of the poses of map 0 from 3 s before the loss on, after one similarity: rms [m].
  double position_error = 0.0;
  double travelled = 0.0;  ///< Along them [m].
  CalibrationReport before;
  CalibrationReport after;
  double calibration_error_px = 0.0;  ///< rms, in the end.
};

/// A rendered room seen through a fov lens of 320 x 240, a calibration learnt for 8 s, then ...
enum class LossKind {
  kBlackout,    ///< the lens is covered for 3 s, and the camera is where it was
  kOtherWay,    ///< the same, but the camera has gone on meanwhile, and comes back beside its way
  kTeleport,    ///< a cut to another room, and back 5 s later
  kMirror,      ///< the lens is covered, then all images are mirrored
  kRepetitive,  ///< a cut to another wall of a room where all walls have the same tiles
  kWhipPan,     ///< a whole turn within 0.6 s, with motion blur
  kCrowd,       ///< people walk through the view for 5 s and hide a quarter of it
  kDenseCrowd,  ///< the same with half of it hidden
  kFlicker      ///< the lens is covered for 1 s, ten times
};

/// All kinds, in the order above.
const std::vector<LossKind>& lossKinds();
std::string toString(LossKind kind);

/// Seeds differ in room, motion and noise.
LossOutcome runLoss(LossKind kind, std::uint64_t seed);

}  // namespace camera_self_calibration
