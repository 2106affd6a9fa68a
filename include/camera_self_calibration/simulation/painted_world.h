#pragma once

#include <vector>

#include "camera_self_calibration/simulation/texture.h"
#include "camera_self_calibration/simulation/world.h"

namespace camera_self_calibration {

/// A world with the textures of its surfaces (painting takes about a second for a room): share it
/// between renderers by a pointer to const.
struct PaintedWorld {
  explicit PaintedWorld(World world_to_paint);

  World world;
  std::vector<Texture> textures;  ///< One a surface.
};

}  // namespace camera_self_calibration
