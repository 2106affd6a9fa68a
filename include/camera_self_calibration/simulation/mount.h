#pragma once

#include <limits>

#include "camera_self_calibration/simulation/trajectory.h"

namespace camera_self_calibration {

/// Where a camera sits on a body that moves, and whether its clock is right.
struct Mount {
  Rigid3 body_from_camera;
  /// From this time on the camera is moved by `bump`, in its own frame [s].
  double bump_at_s = std::numeric_limits<double>::infinity();
  Rigid3 bump;
  double late_s = 0.0;  ///< Images are taken so much after what their stamps say [s].
};

/// The way of a camera, by its stamps, on a body that moves as `body`.
Trajectory mounted(const Trajectory& body, const Mount& mount);

}  // namespace camera_self_calibration
