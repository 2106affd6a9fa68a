#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <vector>

namespace camera_self_calibration {

/// How two cameras were turned at one stamp, each in its own map.
struct RotationPair {
  std::int64_t stamp_ns = 0;
  std::uint64_t rig_map = 0;
  std::uint64_t camera_map = 0;
  Eigen::Quaterniond world_from_rig;
  Eigen::Quaterniond world_from_camera;
};

/// By how much a camera's images were taken after those of the rig's first camera with the same
/// stamp.
struct TimeOffset {
  double seconds = 0.0;
  double sigma = std::numeric_limits<double>::infinity();

  /// Whether it is there, and more than synchronised images may have (0.4 px at 400 px/s).
  bool harms() const;
};

/// From the rates at which two cameras of a rig turn, which are the same vector at the same time:
/// `w_rig(t) = R (w_camera(t) - offset dw_camera/dt)`, solved for R and the offset, robustly. Pairs
/// of successive images, in the order of time; where a map begins the rates do too. Sigma is
/// infinite where there are too few of them.
TimeOffset timeOffset(const std::vector<RotationPair>& rotations);

}  // namespace camera_self_calibration
