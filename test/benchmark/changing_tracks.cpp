#include "benchmark/changing_tracks.h"

#include <optional>
#include <utility>

#include "camera_self_calibration/simulation/room.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"

namespace camera_self_calibration {

FeatureTracks makeTracks(const ChangingTracks& tracks, const Camera& camera,
                         const std::function<Camera(double)>& lens) {
  RoomOptions room;
  room.seed = tracks.seed + 1;
  World world = makeRoom(room);
  SyntheticMotionOptions motion;
  motion.seed = tracks.seed + 2;
  motion.duration_s = tracks.duration_s;
  motion.speed = tracks.motion_speed;
  motion.box = world.free_space;
  FeatureTracksOptions options;
  options.seed = tracks.seed + 3;
  options.max_features = tracks.features;
  options.pixel_sigma = tracks.pixel_sigma;
  options.outlier_share = 0.01;
  options.start_stamp_ns = kChangingTracksStartNs;
  return FeatureTracks(std::move(world), Lens{camera, std::nullopt, 1.0, lens},
                       syntheticMotion(motion), options);
}

}  // namespace camera_self_calibration
