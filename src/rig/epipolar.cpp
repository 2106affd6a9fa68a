#include "camera_self_calibration/rig/epipolar.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace camera_self_calibration {
namespace {

constexpr double kStep = 0.5;  // [px] For the slope across the line.

// n . ray(pixel); not a number where the pixel has no ray.
double height(const Camera& camera, const Eigen::Vector3d& normal, const Eigen::Vector2d& pixel) {
  const auto ray = camera.unproject(pixel);
  return ray ? normal.dot(ray->normalized()) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::vector<SharedView> sharedViews(const RigSegment& segment) {
  const RigViews views{static_cast<int>(segment.tracks.size())};
  std::vector<SharedView> shared;
  for (int from = 0; from < views.cameras; ++from) {
    const Segment& tracks = segment.tracks[from];
    std::map<std::pair<int, int>, const Observation*> own;  // by landmark and frame
    for (const Observation& seen : tracks.observations) {
      if (views.camera(seen.keyframe) != from) continue;
      own[{seen.landmark, views.frame(seen.keyframe)}] = &seen;
    }
    for (const Observation& seen : tracks.observations) {
      const int to = views.camera(seen.keyframe);
      const int frame = views.frame(seen.keyframe);
      const auto here = own.find({seen.landmark, frame});
      if (to == from || here == own.end()) continue;
      shared.push_back({segment.stamps_ns[frame], from, here->second->pixel, to, seen.pixel});
    }
  }
  return shared;
}

std::optional<double> epipolarOffset(const Rig& rig, const SharedView& view) {
  const Rigid3 to_from = rig.rig_from_camera[view.to].inverse() * rig.rig_from_camera[view.from];
  const auto ray = rig.cameras[view.from].unproject(view.from_pixel);
  if (!ray) return std::nullopt;
  const Eigen::Vector3d normal =
      to_from.translation.cross(to_from.rotation * *ray).stableNormalized();
  const Camera& camera = rig.cameras[view.to];
  const Eigen::Vector2d x(kStep, 0.0);
  const Eigen::Vector2d y(0.0, kStep);
  const Eigen::Vector2d& pixel = view.to_pixel;
  const Eigen::Vector2d slope(
      (height(camera, normal, pixel + x) - height(camera, normal, pixel - x)) / (2.0 * kStep),
      (height(camera, normal, pixel + y) - height(camera, normal, pixel - y)) / (2.0 * kStep));
  const double offset = height(camera, normal, pixel) / slope.norm();
  if (!std::isfinite(offset)) return std::nullopt;
  return offset;
}

}  // namespace camera_self_calibration
