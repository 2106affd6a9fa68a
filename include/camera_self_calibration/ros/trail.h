#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/ros/by_map.h"

namespace camera_self_calibration {

/// The whole trajectory in bounded memory: when it is full, every second pose goes and from then on
/// only every second one comes in. A map that was left keeps its own, and goes on with it where it
/// is found again.
class Trail {
 public:
  struct Pose {
    std::int64_t stamp_ns = 0;
    Rigid3 world_from_camera;
  };

  /// `max_poses` is at least 2.
  explicit Trail(std::size_t max_poses) : max_poses_(max_poses) {}

  /// The next pose, of this map. True if it was taken.
  bool add(const Pose& pose, std::uint64_t map_id);

  /// What was recorded of one map goes on in the other.
  void follow(const MapMove& moved);

  /// Of the present map.
  const std::vector<Pose>& poses() const { return ways_.present().poses; }

 private:
  struct Way {
    std::vector<Pose> poses;
    std::uint64_t seen = 0;
    std::uint64_t stride = 1;
    std::size_t size() const { return poses.size(); }
  };

  bool addTo(const Pose& pose, Way* way) const;

  const std::size_t max_poses_;
  ByMap<Way> ways_;
};

}  // namespace camera_self_calibration
