#include "benchmark/degenerate_motion.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/room.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"

namespace camera_self_calibration {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

Surface posterWall(double x, double size, const Vector3d& normal, std::uint64_t seed) {
  TextureRecipe texture;
  texture.kind = TextureKind::kPoster;
  texture.seed = seed;
  return Surface::facing(Vector3d(x, 0.0, 1.8), normal, Vector3d::UnitZ(), size, size, texture);
}

// One large wall at x = 3; all else stands behind a camera that looks at it.
World wallAndCrates(std::uint64_t seed) {
  Random random(mixSeed(seed, 81));
  World world;
  world.surfaces.push_back(posterWall(3.0, 40.0, -Vector3d::UnitX(), seed));
  world.surfaces.push_back(posterWall(-4.0, 20.0, Vector3d::UnitX(), seed + 1));
  TextureRecipe crate;
  crate.kind = TextureKind::kCrate;
  for (int i = 0; i < 12; ++i) {
    crate.seed = seed + 2 + i;
    const Vector3d centre(random.uniform(-3.0, -0.8), random.uniform(-3.0, 3.0),
                          random.uniform(0.2, 3.5));
    const double edge = random.uniform(0.3, 0.8);
    addBox(centre, {edge, edge, edge}, random.uniform(-0.7, 0.7), crate, crate, &world);
  }
  world.free_space = {Vector3d(0.3, -1.2, 1.2), Vector3d(1.7, 1.2, 2.4)};
  return world;
}

// A room hundreds of times as large as the motion in it.
World farWorld(std::uint64_t seed) {
  constexpr double kScale = 100.0;
  RoomOptions options;
  options.seed = seed;
  World world = makeRoom(options);
  const Vector3d middle = world.free_space.center();
  for (Surface& surface : world.surfaces) {
    surface.corner = kScale * (surface.corner - middle) + middle;
    surface.u *= kScale;
    surface.v *= kScale;
  }
  return world;
}

World worldOf(Degeneracy degeneracy, std::uint64_t seed) {
  switch (degeneracy) {
    case Degeneracy::kFrontalPlane:
    case Degeneracy::kVariedPlane:
      return wallAndCrates(seed);
    case Degeneracy::kFarScene:
      return farWorld(seed);
    default:
      break;
  }
  RoomOptions options;
  options.seed = seed;
  return makeRoom(options);
}

// x of the camera to the right, y down, looking along the world's x.
Eigen::Quaterniond towardsWall() {
  Eigen::Matrix3d world_from_camera;
  world_from_camera << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return Eigen::Quaterniond(world_from_camera);
}

// Motions relative to the pose of a hand-held motion at time 0.
Rigid3 onTheSpot(Degeneracy degeneracy, const Rigid3& first, double phase) {
  const double wave = std::sin(phase);
  const auto turned = [&first](double angle, const Vector3d& axis) {
    return Rigid3(first.rotation * Eigen::Quaterniond(AngleAxisd(angle, axis)), first.translation);
  };
  switch (degeneracy) {
    case Degeneracy::kPan:
      return turned(1.2 * wave, Vector3d::UnitY());
    case Degeneracy::kTilt:
      return turned(0.7 * wave, Vector3d::UnitX());
    case Degeneracy::kRoll:
      return turned(1.2 * wave, Vector3d::UnitZ());
    case Degeneracy::kForward:
      return {first.rotation, first.translation + first.rotation * Vector3d(0.0, 0.0, 0.5 * wave)};
    case Degeneracy::kSideways:
      return {first.rotation, first.translation + first.rotation * Vector3d(0.5 * wave, 0.0, 0.0)};
    default:
      return first;
  }
}

Rigid3 beforeWall(Degeneracy degeneracy, const Vector3d& position, double phase) {
  const double roll = 0.6 * std::sin(phase);
  Eigen::Quaterniond rotation = towardsWall();
  if (degeneracy == Degeneracy::kVariedPlane) {
    rotation = rotation * AngleAxisd(0.5 * std::sin(0.7 * phase + 1.0), Vector3d::UnitY()) *
               AngleAxisd(0.4 * std::sin(1.3 * phase), Vector3d::UnitX());
  }
  return Rigid3(rotation * Eigen::Quaterniond(AngleAxisd(roll, Vector3d::UnitZ())), position);
}

Trajectory degenerateMotion(Degeneracy degeneracy, const SyntheticMotionOptions& options,
                            const Trajectory& good) {
  SyntheticMotionOptions own = options;
  own.seed = mixSeed(options.seed, 82);
  if (degeneracy == Degeneracy::kTurning) own.kind = MotionKind::kRotationOnly;
  if (degeneracy == Degeneracy::kYawDriving) own.kind = MotionKind::kYawDriving;
  const Trajectory free = syntheticMotion(own);
  if (own.kind != MotionKind::kHandheld || degeneracy == Degeneracy::kNoTexture) return free;
  const Rigid3 first = good.worldFromCamera(0.0);
  const double rate = 2.0 * M_PI * 0.12 * options.speed;
  const auto pose = [=](double t) {
    const Vector3d position = free.worldFromCamera(t).translation;
    if (degeneracy == Degeneracy::kFarScene) {
      const double angle = 0.5 * std::sin(rate * t);
      return Rigid3(first.rotation * Eigen::Quaterniond(AngleAxisd(angle, Vector3d::UnitY())),
                    position);
    }
    const bool wall =
        degeneracy == Degeneracy::kFrontalPlane || degeneracy == Degeneracy::kVariedPlane;
    return wall ? beforeWall(degeneracy, position, rate * t)
                : onTheSpot(degeneracy, first, rate * t);
  };
  return Trajectory(pose, options.duration_s);
}

// `before` until a time, and from then on `after`, begun at its time 0; no faster between them
// than a hand moves.
Trajectory joined(const Trajectory& before, double at_s, const Trajectory& after) {
  const Rigid3 from = before.worldFromCamera(at_s);
  const Rigid3 to = after.worldFromCamera(0.0);
  const double way = (to.translation - from.translation).norm() / 0.5;
  const double turn = from.rotation.angularDistance(to.rotation) / 0.6;
  const double blend_s = std::max({0.5, way, turn});
  const auto pose = [=](double t) {
    if (t < at_s) return before.worldFromCamera(t);
    const double share = std::clamp((t - at_s) / blend_s, 0.0, 1.0);
    const double weight = share * share * (3.0 - 2.0 * share);
    const Rigid3 end = after.worldFromCamera(std::max(0.0, t - at_s - 0.7 * blend_s));
    return Rigid3(from.rotation.slerp(weight, end.rotation),
                  (1.0 - weight) * from.translation + weight * end.translation);
  };
  return Trajectory(pose, at_s + after.duration());
}

struct Parts {
  World world;
  Trajectory degenerate;
  Trajectory good;
};

Parts makeParts(Degeneracy degeneracy, double degenerate_s, double good_s, std::uint64_t seed) {
  Random random(mixSeed(seed, 80));
  World world = worldOf(degeneracy, seed);
  SyntheticMotionOptions options;
  options.seed = seed;
  options.box = world.free_space;
  if (degeneracy == Degeneracy::kForward || degeneracy == Degeneracy::kSideways) {
    // Room for half a metre each way.
    options.box = {world.free_space.center() - Vector3d(1.2, 0.8, 0.2),
                   world.free_space.center() + Vector3d(1.2, 0.8, 0.2)};
  }
  options.duration_s = good_s;
  options.speed = random.uniform(0.4, 1.0);
  const Trajectory good = syntheticMotion(options);
  options.duration_s = degenerate_s;
  return {std::move(world), degenerateMotion(degeneracy, options, good), good};
}

}  // namespace

std::string toString(Degeneracy degeneracy) {
  const char* const names[] = {"standing", "no texture",  "forward",       "sideways",
                               "pan",      "tilt",        "roll",          "yaw driving",
                               "plane",    "far and pan", "turning (inf)", "varied plane (inf)"};
  return names[static_cast<int>(degeneracy)];
}

bool isInformative(Degeneracy degeneracy) {
  return degeneracy == Degeneracy::kTurning || degeneracy == Degeneracy::kVariedPlane;
}

DegenerateScene makeDegenerateScene(Degeneracy degeneracy, double degenerate_s, double good_s,
                                    std::uint64_t seed) {
  Parts parts = makeParts(degeneracy, degenerate_s, good_s, seed);
  return {std::move(parts.world), joined(parts.degenerate, degenerate_s, parts.good)};
}

DegenerateScene makeLateDegenerateScene(Degeneracy degeneracy, double good_s, double degenerate_s,
                                        std::uint64_t seed) {
  Parts parts = makeParts(degeneracy, degenerate_s, good_s, seed);
  return {std::move(parts.world), joined(parts.good, good_s, parts.degenerate)};
}

}  // namespace camera_self_calibration
