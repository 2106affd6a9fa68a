#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

/// Keyframe::lens of a keyframe that was taken with the lens that is being estimated.
inline constexpr int kPresentLens = -1;

struct Keyframe {
  std::int64_t id = 0;  ///< Counts keyframes since the start.
  std::int64_t stamp_ns = 0;
  Rigid3 world_from_camera;
  /// Motion of the camera from its neighbouring frames: se(3) twist per second, in the camera frame
  /// [map unit/s, rad/s].
  Vector6d velocity = Vector6d::Zero();
  /// Between image rows: that of the rolling shutter that its pixels are freed of; 0: as seen [s].
  double line_delay_s = 0.0;
  std::uint64_t calibration_generation = 0;  ///< Of the intrinsics its pose was estimated with.
  int lens = kPresentLens;                   ///< Which of Segment::held_lenses took it, if one did.
};

/// What a rolling shutter did to a pixel.
struct RowShift {
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  ///< The pixel as seen, from where it is put.
  ImageMotion motion = {};
};

/// A point as inverse depth along a ray of its reference keyframe (eq. 1).
struct Landmark {
  std::int64_t track_id = 0;
  int reference = 0;  ///< Index into Segment::keyframes.
  /// True: the ray is that of reference_pixel under the current intrinsics, and the reference
  /// keyframe has no observation of it: one parameter. False ("inherited"; the track was detected
  /// before the segment begins): `bearing` is a parameter, and the first observation in the
  /// segment, in `reference`, is a residual too: three parameters.
  bool anchored = true;
  Eigen::Vector2d reference_pixel = Eigen::Vector2d::Zero();
  RowShift reference_shift = {};
  Eigen::Vector3d bearing = Eigen::Vector3d::UnitZ();  ///< Unit, in the reference keyframe.
  double inverse_depth = 1.0;  ///< rho [1/map unit]; <= 0 and -> 0 stay finite.
};

struct Observation {
  int landmark = 0;  ///< Index into Segment::landmarks.
  int keyframe = 0;  ///< Index into Segment::keyframes.
  /// As seen by a global shutter at the time of the middle row (see rolling_shutter.h).
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double sigma = 1.0;  ///< Standard deviation per axis [px].
  RowShift shift = {};
};

/// A part of the trajectory that stands for itself: a plain value, with indices and no pointers.
/// Keyframes in the order of time, observations grouped by landmark.
struct Segment {
  std::int64_t sequence = 0;  ///< Unique among segments; identity of a copy.
  std::vector<Keyframe> keyframes;
  std::vector<Landmark> landmarks;
  std::vector<Observation> observations;
  /// Lenses that are given, not estimated: where the physical camera changed within the segment,
  /// that of its first keyframes; of a rig, whose keyframes are the images of several cameras,
  /// those of all of them.
  std::vector<Camera> held_lenses;

  /// Whether a keyframe was taken with a lens that is held.
  bool isLensHeld(int keyframe) const { return keyframes[keyframe].lens != kPresentLens; }
  /// The intrinsics that a keyframe was taken with; `present`: those that are being estimated.
  const Camera& cameraOf(int keyframe, const Camera& present) const {
    const int lens = keyframes[keyframe].lens;
    return lens == kPresentLens ? present : held_lenses[lens];
  }

  std::int64_t beginNs() const { return keyframes.empty() ? 0 : keyframes.front().stamp_ns; }
  std::int64_t endNs() const { return keyframes.empty() ? 0 : keyframes.back().stamp_ns; }
};

}  // namespace camera_self_calibration
