#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/simulation/trajectory.h"

namespace camera_self_calibration {

enum class MotionKind {
  kHandheld,      ///< All six degrees of freedom, smooth; informs about all intrinsics.
  kPlanar,        ///< Height constant and camera upright; free motion and turning in the plane.
  kYawDriving,    ///< As a car: round course, camera looks along the path.
  kRotationOnly,  ///< Turns about all three axes on the spot.
  kForwardOnly,   ///< Forth and back along the optical axis, no rotation.
  kSidewaysOnly,  ///< Left and right, no rotation.
  kStill
};

/// "handheld", "planar", "yaw_driving", "rotation_only", "forward_only", "sideways_only", "still".
std::string toString(MotionKind kind);
/// Nothing for any other string.
std::optional<MotionKind> motionKindFromString(const std::string& name);

struct SyntheticMotionOptions {
  MotionKind kind = MotionKind::kHandheld;
  std::uint64_t seed = 1;
  double duration_s = 60.0;
  /// Positions stay inside; see World::free_space [m].
  Eigen::AlignedBox3d box{Eigen::Vector3d(-1.9, -1.4, 1.1), Eigen::Vector3d(1.9, 1.4, 2.5)};
  double speed = 1.0;  ///< Factor on all frequencies; 1: about 0.6 m/s, turning at about 40 deg/s.

  /// Every violated bound in one sentence each; empty if all is well.
  std::vector<std::string> problems() const;
};

/// A seeded motion made of sinusoids: smooth in all derivatives. The world's z points up.
/// Throws std::invalid_argument that lists options.problems().
Trajectory syntheticMotion(const SyntheticMotionOptions& options);

}  // namespace camera_self_calibration
