#pragma once

#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/geometry/rigid3.h"

namespace camera_self_calibration {

/// Cameras that are fixed to one body. The rig's frame is that of its first camera.
struct Rig {
  std::vector<Camera> cameras;
  /// One for each camera, the first the identity. Lengths are in map units until something metric
  /// is known.
  std::vector<Rigid3> rig_from_camera;

  int size() const { return static_cast<int>(cameras.size()); }
};

/// Distances between the first two cameras of a rig that can be right [m].
constexpr double kShortestBaseline = 1e-3;
constexpr double kLongestBaseline = 1e3;

/// False for NaN too.
constexpr bool isBaseline(double metres) {
  return metres >= kShortestBaseline && metres <= kLongestBaseline;
}

/// What one observation belongs to: a camera's image in a frame of the rig. Segments of rigs have
/// one keyframe for each, `frame * cameras + camera`.
struct RigViews {
  int cameras = 1;

  int index(int frame, int camera) const { return frame * cameras + camera; }
  int frame(int view) const { return view / cameras; }
  int camera(int view) const { return view % cameras; }
};

}  // namespace camera_self_calibration
