#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "camera_self_calibration/geometry/rigid3.h"

namespace camera_self_calibration {

/// The whole trajectory in bounded memory: when it is full, every second pose goes and from then on
/// only every second one comes in.
class Trail {
 public:
  struct Pose {
    std::int64_t stamp_ns = 0;
    Rigid3 world_from_camera;
  };

  /// `max_poses` is at least 2.
  explicit Trail(std::size_t max_poses) : max_poses_(max_poses) {}

  /// Poses of one map; the first of another map clears the trail. True if the pose was taken.
  bool add(const Pose& pose, std::uint64_t map_id);

  const std::vector<Pose>& poses() const { return poses_; }

 private:
  void thinOut();

  const std::size_t max_poses_;
  std::vector<Pose> poses_;
  std::uint64_t map_id_ = 0;
  std::uint64_t seen_ = 0;
  std::uint64_t stride_ = 1;
};

}  // namespace camera_self_calibration
