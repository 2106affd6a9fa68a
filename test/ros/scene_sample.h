#pragma once

#include <vector>

#include "camera_self_calibration/ros/scene.h"

namespace camera_self_calibration {

inline Camera sceneCamera() {
  return Camera(CameraModel::kPinhole, 640, 480, (Intrinsics(4) << 320, 320, 320, 240).finished());
}

/// Keyframes `first` to `first + count - 1`, a second and a step of 0.1 along x apart, all of which
/// see four points 2 in front of the first of them.
inline Segment sceneSegment(std::int64_t first, int count) {
  Segment segment;
  for (int i = 0; i < count; ++i) {
    Keyframe keyframe;
    keyframe.id = first + i;
    keyframe.stamp_ns = keyframe.id * 1000000000LL;
    keyframe.world_from_camera.translation.x() = 0.1 * static_cast<double>(keyframe.id);
    segment.keyframes.push_back(keyframe);
  }
  for (int p = 0; p < 4; ++p) {
    Landmark landmark;
    landmark.track_id = 10 * first + p;
    landmark.reference_pixel = {320.0 + 16.0 * p, 240.0};
    landmark.inverse_depth = 0.5;
    segment.landmarks.push_back(landmark);
    for (int k = 0; k < count; ++k) {
      segment.observations.push_back({p, k, landmark.reference_pixel, 1.0});
    }
  }
  return segment;
}

/// A queue of two segments: seconds 0 to 3 with the lower entropy, and 5 to 8.
inline CalibrationReport sceneReport() {
  CalibrationReport report;
  report.camera = sceneCamera();
  report.state = CalibrationState::kConverged;
  report.queue.segments.push_back({1, 0, 3000000000LL, 5.0, 4, 10, 40});
  report.queue.segments.push_back({2, 5000000000LL, 8000000000LL, 7.0, 4, 10, 40});
  return report;
}

}  // namespace camera_self_calibration
