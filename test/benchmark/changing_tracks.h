#pragma once

#include <cstdint>
#include <functional>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/simulation/feature_tracks.h"

namespace camera_self_calibration {

/// Feature tracks of a hand-held camera in a furnished room. The seed decides on the room, the
/// motion and the noise.
struct ChangingTracks {
  std::uint64_t seed = 1;
  double duration_s = 75.0;
  double motion_speed = 0.6;
  double pixel_sigma = 0.15;  ///< Beside 1 % of outliers [px].
  int features = 100;
};

constexpr std::int64_t kChangingTracksStartNs = 1000000000;

/// `lens`, if given, tells the camera at a time since the start [s]; else it stays `camera`.
FeatureTracks makeTracks(const ChangingTracks& tracks, const Camera& camera,
                         const std::function<Camera(double)>& lens);

}  // namespace camera_self_calibration
