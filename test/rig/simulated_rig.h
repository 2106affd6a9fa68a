#pragma once

#include <cstdint>
#include <vector>

#include "camera_self_calibration/rig/across_images.h"
#include "camera_self_calibration/rig/rig.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"

namespace camera_self_calibration {

struct SimulatedRigOptions {
  Rig rig;  ///< The true one [m].
  std::uint64_t seed = 1;
  int frames = 40;          ///< Keyframes.
  double interval_s = 0.2;  ///< Between them.
  double pixel_sigma = 0.2;
  double outlier_share = 0.0;
  MotionKind motion = MotionKind::kHandheld;
  /// Errors of the poses that each camera knows of itself, and of its scale.
  double position_sigma_m = 0.003;
  double rotation_sigma_rad = 0.002;
  int max_features = 60;
  /// From this time on the camera `changed` is another: moved in its own frame by `bump`, and its
  /// focal lengths multiplied by `zoom`.
  double change_at_s = 1e9;
  int changed = 1;
  Rigid3 bump;
  double zoom = 1.0;
};

/// An equidistant lens of 640 x 480 pixels.
Camera rigLens(double focal, double k1);

/// Two cameras side by side, 0.12 m apart.
Rig stereoRig();

/// A rig that moves through a furnished room: tracks of each camera, poses in a map of its own, and
/// what cameras see of each other's features.
struct SimulatedRig {
  Rig truth;
  std::vector<RigFrame> frames;
  FindAcross across;  ///< Noisy; what is hidden or out of the image is not found.
};

/// The rig at a time since the change: `rig_from_camera * bump`, whichever camera it is.
Rig afterBump(const SimulatedRigOptions& options);

SimulatedRig simulateRig(const SimulatedRigOptions& options);

/// The angle between two rotations [rad].
double angleBetween(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);
/// The angle between two directions [rad].
double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace camera_self_calibration
