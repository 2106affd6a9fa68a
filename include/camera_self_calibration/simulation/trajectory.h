#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "camera_self_calibration/geometry/rigid3.h"

namespace camera_self_calibration {

/// A camera's motion: a smooth function of time on [0, duration].
class Trajectory {
 public:
  /// `world_from_camera` is called with times in [0, duration_s] only.
  Trajectory(std::function<Rigid3(double)> world_from_camera, double duration_s)
      : pose_(std::move(world_from_camera)), duration_s_(duration_s) {}

  /// The pose at a time [s]; times outside [0, duration] give the pose at the nearer end.
  Rigid3 worldFromCamera(double time_s) const;

  /// Motion per second in the camera's own frame: se(3) twist (translation, rotation) [m/s, rad/s],
  /// from central differences.
  Vector6d velocity(double time_s) const;

  double duration() const { return duration_s_; }  ///< [s]

 private:
  std::function<Rigid3(double)> pose_;
  double duration_s_;
};

struct StampedPose {
  double time_s = 0.0;
  Rigid3 world_from_body;
};

/// Interpolates poses smoothly: cubic Hermite (Catmull-Rom for uneven steps) in the translation and
/// in the rotation vector of each step, so that velocities are continuous. Time 0 is the first
/// pose's. Throws std::invalid_argument for fewer than two poses or times that do not increase.
Trajectory interpolate(const std::vector<StampedPose>& poses);

}  // namespace camera_self_calibration
