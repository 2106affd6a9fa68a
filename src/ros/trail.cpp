#include "camera_self_calibration/ros/trail.h"

namespace camera_self_calibration {

bool Trail::add(const Pose& pose, std::uint64_t map_id) {
  if (map_id != map_id_) {
    poses_.clear();
    map_id_ = map_id;
    seen_ = 0;
    stride_ = 1;
  }
  if (seen_++ % stride_ != 0) return false;
  if (poses_.size() == max_poses_) thinOut();
  poses_.push_back(pose);
  return true;
}

void Trail::thinOut() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < poses_.size(); i += 2) poses_[kept++] = poses_[i];
  poses_.resize(kept);
  stride_ *= 2;
}

}  // namespace camera_self_calibration
