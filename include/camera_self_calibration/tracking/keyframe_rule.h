#pragma once

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/tracking/track.h"
#include "camera_self_calibration/tracking/tracking_options.h"

namespace camera_self_calibration {

/// Decides from tracks alone whether an image becomes a keyframe: on pixel parallax after removing
/// the rotation, on rotation, and on tracks lost since the last keyframe. Never on translation in
/// map units, whose scale is arbitrary. A still camera makes no keyframe, until it has lost nearly
/// all tracks.
class KeyframeRule {
 public:
  explicit KeyframeRule(const KeyframeOptions& options) : options_(options) {}

  /// `camera` serves to remove the rotation; it may be a rough guess. `spacing` multiplies
  /// min_parallax and min_rotation_deg.
  bool isKeyframe(const TrackedFrame& frame, const Camera& camera, double spacing = 1.0) const;

  /// The frame that later ones are compared with (with the tracks detected in it).
  void setKeyframe(const TrackedFrame& frame) { last_ = frame; }
  void reset() { last_ = TrackedFrame(); }

 private:
  KeyframeOptions options_;
  TrackedFrame last_;
};

}  // namespace camera_self_calibration
