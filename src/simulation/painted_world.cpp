#include "camera_self_calibration/simulation/painted_world.h"

#include "camera_self_calibration/simulation/texture_paint.h"

namespace camera_self_calibration {

PaintedWorld::PaintedWorld(World world_to_paint, std::vector<MovingBody> bodies_to_paint)
    : world(std::move(world_to_paint)), bodies(std::move(bodies_to_paint)) {
  const auto paint = [this](const std::vector<Surface>& surfaces) {
    for (const Surface& surface : surfaces) {
      textures.emplace_back(paintTexture(surface.texture, surface.u.norm(), surface.v.norm()));
    }
  };
  paint(world.surfaces);
  for (const MovingBody& body : bodies) paint(body.surfaces);
}

}  // namespace camera_self_calibration
