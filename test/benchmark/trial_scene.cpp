#include "benchmark/trial_scene.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/room.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"

namespace camera_self_calibration {
namespace {

World wall(std::uint64_t seed) {
  World world;
  TextureRecipe texture;
  texture.kind = TextureKind::kPoster;
  texture.seed = seed;
  world.surfaces.push_back(Surface::facing(Eigen::Vector3d(3.0, 0.0, 1.8),
                                           -Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ(),
                                           40.0, 40.0, texture));
  world.free_space = {Eigen::Vector3d(-1.9, -1.4, 1.1), Eigen::Vector3d(1.9, 1.4, 2.5)};
  return world;
}

// Positions of a hand-held motion, with orientations of its first pose turned about one axis of the
// camera by up to `angle` [rad].
Trajectory oneAxis(const Trajectory& free, const Eigen::Vector3d& axis, double angle, bool moves,
                   const Eigen::Quaterniond& first, double frequency_hz) {
  return Trajectory(
      [=](double t) {
        const double turned = angle * std::sin(2.0 * M_PI * frequency_hz * t);
        const Eigen::Quaterniond rotation(first * Eigen::AngleAxisd(turned, axis));
        return Rigid3(rotation, free.worldFromCamera(moves ? t : 0.0).translation);
      },
      free.duration());
}

// x of the camera to the right, y down, looking along the world's x.
Eigen::Quaterniond towardsWall() {
  Eigen::Matrix3d world_from_camera;
  world_from_camera << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return Eigen::Quaterniond(world_from_camera);
}

MotionKind kindOf(Scene scene) {
  switch (scene) {
    case Scene::kForward:
      return MotionKind::kForwardOnly;
    case Scene::kSideways:
      return MotionKind::kSidewaysOnly;
    case Scene::kYawDriving:
      return MotionKind::kYawDriving;
    case Scene::kOneAxis:
    case Scene::kPlane:
    case Scene::kHandheld:
      break;
  }
  return MotionKind::kHandheld;
}

Trajectory afterIdling(const Trajectory& good, Idle idle, double idle_s) {
  if (idle == Idle::kNone) return good;
  const auto pose = [=](double t) {
    constexpr double kGentleStart = 1.0;  // [s]
    const double moving = std::max(0.0, t - idle_s);
    const double ramp =
        moving < kGentleStart ? 0.5 * moving * moving / kGentleStart : moving - 0.5 * kGentleStart;
    Rigid3 result = good.worldFromCamera(ramp);
    if (idle == Idle::kDriving && t < idle_s) {
      const double along = 0.4 * std::sin(2.0 * M_PI * 0.25 * (t - idle_s));
      result.translation += result.rotation * Eigen::Vector3d(0.0, 0.0, along);
    }
    return result;
  };
  return Trajectory(pose, idle_s + good.duration());
}

}  // namespace

std::string toString(Scene scene) {
  const char* const names[] = {"handheld", "forward", "sideways", "one axis", "driving", "plane"};
  return names[static_cast<int>(scene)];
}

std::string toString(Idle idle) {
  const char* const names[] = {"none", "standing", "driving straight", "no texture"};
  return names[static_cast<int>(idle)];
}

TrialScene makeScene(Scene scene, double good_s, Idle idle, double idle_s, std::uint64_t seed) {
  Random random(mixSeed(seed, 78));
  RoomOptions room;
  room.seed = seed;
  World world = scene == Scene::kPlane ? wall(seed) : makeRoom(room);
  SyntheticMotionOptions options;
  options.kind = kindOf(scene);
  options.seed = seed;
  options.box = world.free_space;
  options.duration_s = good_s;
  options.speed = random.uniform(0.4, 1.0);
  Trajectory motion = syntheticMotion(options);
  const double frequency = 0.1 * options.speed;
  if (scene == Scene::kOneAxis) {
    motion = oneAxis(motion, Eigen::Vector3d::UnitY(), 1.2, false,
                     motion.worldFromCamera(0.0).rotation, frequency);
  } else if (scene == Scene::kPlane) {
    motion = oneAxis(motion, Eigen::Vector3d::UnitZ(), 0.6, true, towardsWall(), frequency);
  }
  return {std::move(world), afterIdling(motion, idle, idle_s)};
}

}  // namespace camera_self_calibration
