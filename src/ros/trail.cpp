#include "camera_self_calibration/ros/trail.h"

namespace camera_self_calibration {

bool Trail::add(const Pose& pose, std::uint64_t map_id) {
  return addTo(pose, &ways_.enter(map_id));
}

void Trail::follow(const MapMove& moved) {
  ways_.join(moved.from, moved.to, [&](const Way& left, Way* into) {
    for (Pose pose : left.poses) {
      pose.world_from_camera = moved.to_from_from * pose.world_from_camera;
      addTo(pose, into);
    }
  });
}

bool Trail::addTo(const Pose& pose, Way* way) const {
  if (way->seen++ % way->stride != 0) return false;
  if (way->poses.size() == max_poses_) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < way->poses.size(); i += 2) way->poses[kept++] = way->poses[i];
    way->poses.resize(kept);
    way->stride *= 2;
  }
  way->poses.push_back(pose);
  return true;
}

}  // namespace camera_self_calibration
