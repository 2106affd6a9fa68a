#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/simulation/trajectory.h"
#include "camera_self_calibration/simulation/world.h"

namespace camera_self_calibration {

/// Surfaces that move together, rigidly, through a world.
struct MovingBody {
  std::vector<Surface> surfaces;                  ///< In the body's own frame.
  std::function<Rigid3(double)> world_from_body;  ///< By time [s].
};

struct MovingObjectsOptions {
  double share = 0.0;    ///< Of the image, covered in the mean over time, [0, 0.5]; 0: no objects.
  bool carried = false;  ///< Fixed to the camera, as a robot's arm is; else each moves by itself.
  std::uint64_t seed = 1;

  /// Every violated bound in one sentence each; empty if all is well.
  std::vector<std::string> problems() const;
};

/// Textured cubes before the scene, within a metre of the camera. Those that move by themselves
/// keep company with it: they stay about where it looks and wander, near and far, and turn there.
/// Throws std::invalid_argument that lists options.problems().
std::vector<MovingBody> movingObjects(const MovingObjectsOptions& options, const Camera& camera,
                                      const Trajectory& motion);

/// Share of a camera's pixels that see one of the bodies, on a grid of 32 x 24 of them.
double coveredShare(const std::vector<MovingBody>& bodies, const Camera& camera,
                    const Rigid3& world_from_camera, double time_s);

}  // namespace camera_self_calibration
