#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

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
  int camera = 0;                            ///< Which of Segment::cameras took it.
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
  /// Intrinsics of the first `earlier_keyframes` keyframes where the physical camera changed within
  /// it: known, and held. Null: there was no change.
  std::shared_ptr<const Camera> earlier_camera;
  int earlier_keyframes = 0;
  /// Of a rig, whose keyframes are the images of several cameras; empty: all are of one camera.
  std::vector<Camera> cameras;

  /// Whether a keyframe was taken before the change.
  bool isEarlier(int keyframe) const { return earlier_camera && keyframe < earlier_keyframes; }
  /// The intrinsics that a keyframe was taken with; `present` where they did not change.
  const Camera& cameraOf(int keyframe, const Camera& present) const {
    if (isEarlier(keyframe)) return *earlier_camera;
    return cameras.empty() ? present : cameras[keyframes[keyframe].camera];
  }

  std::int64_t beginNs() const { return keyframes.empty() ? 0 : keyframes.front().stamp_ns; }
  std::int64_t endNs() const { return keyframes.empty() ? 0 : keyframes.back().stamp_ns; }
};

}  // namespace camera_self_calibration
