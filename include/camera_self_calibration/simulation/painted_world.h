#pragma once

#include <vector>

#include "camera_self_calibration/simulation/moving_objects.h"
#include "camera_self_calibration/simulation/texture.h"
#include "camera_self_calibration/simulation/world.h"

namespace camera_self_calibration {

/// A world and what moves in it, with the textures of the surfaces (painting takes about a second
/// for a room): share it between renderers by a pointer to const.
struct PaintedWorld {
  explicit PaintedWorld(World world_to_paint, std::vector<MovingBody> bodies_to_paint = {});

  World world;
  std::vector<MovingBody> bodies;
  std::vector<Texture> textures;  ///< One a surface: those of the world, then of each body.
};

}  // namespace camera_self_calibration
