#pragma once

#include <Eigen/Core>
#include <vector>

#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/rig/rig_segment.h"

namespace camera_self_calibration {

/// What two cameras did over the same time, each in its own map: `begin_from_end`.
struct MotionPair {
  Rigid3 rig;     ///< Of the rig's first camera.
  Rigid3 camera;  ///< Of another one; its lengths have a scale of their own.
};

/// Where a camera sits in the rig, as motion alone tells it.
struct HandEye {
  /// Of rig_from_camera. Turning about one axis only leaves the turn about this axis open.
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  double rotation_sigma = 0.0;  ///< About the axis that is known least [rad].
  /// In units of the rig's map, at least squares: rough, since the lever's share of a motion is
  /// small. Zero where it is told by nothing.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

/// The pose of a camera in the rig from `rig X = X camera` over many motions: the rotation from
/// those of the motions (`w_rig = R w_camera`, Kabsch, reweighted against outliers), then position
/// and scale from `(R_rig - I) t + t_rig = s R t_camera`. `rotation_sigma` is infinite where there
/// are fewer than three motions.
HandEye handEye(const std::vector<MotionPair>& motions);

/// The motions of a camera and the first one between frames about `interval_s` apart in which both
/// have the same map at both ends. Where one of the two had several maps, those of the pair of maps
/// with most frames, so that lengths compare.
std::vector<MotionPair> motionPairs(const std::vector<RigFrame>& frames, int camera,
                                    double interval_s);

}  // namespace camera_self_calibration
