#include "camera_self_calibration/simulation/surface_view.h"

namespace camera_self_calibration {
namespace {

constexpr double kNearest = 1e-3;  // [m] surfaces nearer to the eye are not seen
constexpr float kEdge = 1e-6f;     // [rad] by which surfaces overlap, so that none gap

SurfaceView viewOf(const Surface& surface, const Texture& texture,
                   const Rigid3& world_from_camera) {
  const Eigen::Vector3d normal = surface.normal();
  // From the eye to the surface's plane, along the normal: negative where the front is seen.
  const double height = normal.dot(surface.corner - world_from_camera.translation);
  if (height > -kNearest) return SurfaceView();
  // A ray meets the plane at distance height / (normal.d); inserted into the position along u and
  // v and multiplied by the inverse distance, everything is linear in d.
  const Eigen::Vector3d from_corner = world_from_camera.translation - surface.corner;
  const Eigen::Vector3d inverse_distance = normal / height;
  const Eigen::Vector3d u = texture.width() / surface.u.squaredNorm() * surface.u;
  const Eigen::Vector3d v = texture.height() / surface.v.squaredNorm() * surface.v;
  const Eigen::Matrix3d camera_from_world =
      world_from_camera.rotation.conjugate().toRotationMatrix();
  const Eigen::Vector3d q = camera_from_world * inverse_distance;
  const Eigen::Vector3d x = camera_from_world * (from_corner.dot(u) * inverse_distance + u);
  const Eigen::Vector3d y = camera_from_world * (from_corner.dot(v) * inverse_distance + v);
  SurfaceView view;
  view.texture = &texture;
  view.x = x.cast<float>();
  view.y = y.cast<float>();
  view.inverse_distance = q.cast<float>();
  view.borders.col(0) = x.normalized().cast<float>();
  view.borders.col(1) = (texture.width() * q - x).normalized().cast<float>();
  view.borders.col(2) = y.normalized().cast<float>();
  view.borders.col(3) = (texture.height() * q - y).normalized().cast<float>();
  view.borders.col(4) = q.normalized().cast<float>();
  return view;
}

}  // namespace

SurfaceView::Cover SurfaceView::cover(const RayCone& cone) const {
  if (texture == nullptr) return Cover::kNone;
  Cover result = Cover::kAll;
  for (int i = 0; i < 5; ++i) {
    const float middle = borders.col(i).dot(cone.axis);
    if (middle < -cone.chord) return Cover::kNone;
    if (middle <= cone.chord) result = Cover::kPart;
  }
  return result;
}

bool SurfaceView::meets(const Eigen::Vector3f& ray) const {
  if (texture == nullptr) return false;
  for (int i = 0; i < 4; ++i) {
    if (borders.col(i).dot(ray) <= -kEdge) return false;
  }
  return inverse_distance.dot(ray) > 0.0f;
}

std::vector<SurfaceView> viewsFrom(const PaintedWorld& world, const Rigid3& world_from_camera,
                                   double time_s) {
  std::vector<SurfaceView> views;
  const auto add = [&](const std::vector<Surface>& surfaces, const Rigid3& frame_from_camera) {
    for (const Surface& surface : surfaces) {
      views.push_back(viewOf(surface, world.textures[views.size()], frame_from_camera));
    }
  };
  add(world.world.surfaces, world_from_camera);
  for (const MovingBody& body : world.bodies) {
    add(body.surfaces, body.world_from_body(time_s).inverse() * world_from_camera);
  }
  return views;
}

}  // namespace camera_self_calibration
