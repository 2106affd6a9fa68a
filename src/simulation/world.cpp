#include "camera_self_calibration/simulation/world.h"

#include <cmath>

#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {

Surface Surface::facing(const Eigen::Vector3d& centre, const Eigen::Vector3d& normal,
                        const Eigen::Vector3d& up, double width, double height,
                        const TextureRecipe& texture) {
  Surface surface;
  surface.u = width * up.cross(normal);  // to the right for a viewer who looks along -normal
  surface.v = -height * up;
  surface.corner = centre - 0.5 * (surface.u + surface.v);
  surface.texture = texture;
  return surface;
}

std::optional<Hit> World::castRay(const Eigen::Vector3d& origin,
                                  const Eigen::Vector3d& direction) const {
  std::optional<Hit> nearest;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const Surface& surface = surfaces[i];
    const Eigen::Vector3d normal = surface.v.cross(surface.u);
    const double approach = normal.dot(direction);
    if (!(approach < 0.0)) continue;  // parallel, or seen from behind
    const double distance = normal.dot(surface.corner - origin) / approach;
    if (distance <= 0.0 || (nearest && distance >= nearest->distance)) continue;
    const Eigen::Vector3d offset = origin + distance * direction - surface.corner;
    const double a = offset.dot(surface.u) / surface.u.squaredNorm();
    const double b = offset.dot(surface.v) / surface.v.squaredNorm();
    if (a < 0.0 || a > 1.0 || b < 0.0 || b > 1.0) continue;
    nearest = Hit{static_cast<int>(i), distance, a, b};
  }
  return nearest;
}

bool World::visible(const Eigen::Vector3d& eye, const Eigen::Vector3d& point) const {
  const std::optional<Hit> hit = castRay(eye, point - eye);
  return !hit || hit->distance > 1.0 - 1e-4;  // the point's own surface is met at 1
}

void addBox(const Eigen::Vector3d& centre, const Eigen::Vector3d& size, double yaw,
            const TextureRecipe& sides, const TextureRecipe& top, World* world) {
  const Eigen::Vector3d x(std::cos(yaw), std::sin(yaw), 0.0);
  const Eigen::Vector3d y(-std::sin(yaw), std::cos(yaw), 0.0);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  std::uint64_t face = 0;
  const auto add = [&](const Eigen::Vector3d& normal, const Eigen::Vector3d& face_up, double depth,
                       double width, double height, TextureRecipe texture) {
    texture.seed = mixSeed(texture.seed, ++face);
    world->surfaces.push_back(
        Surface::facing(centre + 0.5 * depth * normal, normal, face_up, width, height, texture));
  };
  add(x, up, size.x(), size.y(), size.z(), sides);
  add(-x, up, size.x(), size.y(), size.z(), sides);
  add(y, up, size.y(), size.x(), size.z(), sides);
  add(-y, up, size.y(), size.x(), size.z(), sides);
  add(up, y, size.z(), size.x(), size.y(), top);
  add(-up, y, size.z(), size.x(), size.y(), top);
}

}  // namespace camera_self_calibration
