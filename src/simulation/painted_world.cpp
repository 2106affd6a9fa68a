#include "camera_self_calibration/simulation/painted_world.h"

#include "camera_self_calibration/simulation/texture_paint.h"

namespace camera_self_calibration {

PaintedWorld::PaintedWorld(World world_to_paint) : world(std::move(world_to_paint)) {
  textures.reserve(world.surfaces.size());
  for (const Surface& surface : world.surfaces) {
    textures.emplace_back(paintTexture(surface.texture, surface.u.norm(), surface.v.norm()));
  }
}

}  // namespace camera_self_calibration
