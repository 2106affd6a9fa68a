#include "camera_self_calibration/simulation/moving_objects.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"

namespace camera_self_calibration {
namespace {

constexpr int kObjects = 4;
constexpr double kDistance = 0.7;  // [m] Nearer than what stands in a room, as a rule.
constexpr double kDepth = 0.1;     // [m] By which they come nearer and go away.
// [m] The corners of a cube of this edge still stay in front of the camera.
constexpr double kLargest = 1.1 * (kDistance - kDepth);
constexpr double kWidest = 50.0 * kDegree;  // From the optical axis: their middle.
constexpr int kSamples = 12;                // In time, for the mean of what is covered.

constexpr int kGridColumns = 32;
constexpr int kGridRows = 24;

std::vector<Surface> cube(double edge, std::uint64_t seed) {
  TextureRecipe paint;
  paint.kind = TextureKind::kCrate;
  paint.seed = seed;
  paint.texels_per_metre = 400.0;
  World alone;
  addBox(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(edge), 0.0, paint, paint, &alone);
  return alone.surfaces;
}

// Before the camera, in its frame: the middles of objects that it sees.
Eigen::AlignedBox3d viewOf(const Camera& camera) {
  const auto reach = [](double half_size, double focal_length) {
    return kDistance * std::tan(std::min(kWidest, 0.8 * std::atan(half_size / focal_length)));
  };
  const Intrinsics& lens = camera.parameters();
  const Eigen::Vector3d half(reach(0.5 * camera.width(), lens[0]),
                             reach(0.5 * camera.height(), lens[1]), kDepth);
  const Eigen::Vector3d middle(0.0, 0.0, kDistance);
  return Eigen::AlignedBox3d(middle - half, middle + half);
}

// All cubes with this edge [m].
std::vector<MovingBody> cubes(const MovingObjectsOptions& options, const Camera& camera,
                              const Trajectory& motion, double edge) {
  std::vector<MovingBody> bodies;
  for (std::uint64_t i = 0; i < kObjects; ++i) {
    SyntheticMotionOptions own;
    own.kind = options.carried ? MotionKind::kStill : MotionKind::kHandheld;
    own.seed = mixSeed(options.seed, i);
    own.duration_s = motion.duration();
    own.box = viewOf(camera);
    const Trajectory in_view = syntheticMotion(own);
    bodies.push_back({cube(edge, own.seed), [motion, in_view](double time_s) {
                        return motion.worldFromCamera(time_s) * in_view.worldFromCamera(time_s);
                      }});
  }
  return bodies;
}

double meanShare(const std::vector<MovingBody>& bodies, const Camera& camera,
                 const Trajectory& motion) {
  double sum = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double time = motion.duration() * (i + 0.5) / kSamples;
    sum += coveredShare(bodies, camera, motion.worldFromCamera(time), time);
  }
  return sum / kSamples;
}

}  // namespace

std::vector<std::string> MovingObjectsOptions::problems() const {
  if (share >= 0.0 && share <= 0.5) return {};
  return {"moving objects must cover a share in [0, 0.5] of the image"};
}

std::vector<MovingBody> movingObjects(const MovingObjectsOptions& options, const Camera& camera,
                                      const Trajectory& motion) {
  for (const std::string& problem : options.problems()) throw std::invalid_argument(problem);
  if (options.share == 0.0) return {};
  double small = 0.0;
  double large = kLargest;
  while (large - small > 1e-3 * kLargest) {
    const double edge = 0.5 * (small + large);
    const bool enough =
        meanShare(cubes(options, camera, motion, edge), camera, motion) >= options.share;
    (enough ? large : small) = edge;
  }
  return cubes(options, camera, motion, large);
}

double coveredShare(const std::vector<MovingBody>& bodies, const Camera& camera,
                    const Rigid3& world_from_camera, double time_s) {
  std::vector<std::pair<World, Rigid3>> seen;  // and where the camera is in its frame
  for (const MovingBody& body : bodies) {
    World alone;
    alone.surfaces = body.surfaces;
    seen.emplace_back(std::move(alone), body.world_from_body(time_s).inverse() * world_from_camera);
  }
  int covered = 0;
  for (int i = 0; i < kGridColumns * kGridRows; ++i) {
    const Eigen::Vector2d pixel((i % kGridColumns + 0.5) * camera.width() / kGridColumns - 0.5,
                                (i / kGridColumns + 0.5) * camera.height() / kGridRows - 0.5);
    const auto ray = camera.unproject(pixel);
    covered += ray && std::any_of(seen.begin(), seen.end(), [&](const auto& body) {
                 const auto& [alone, eye] = body;
                 return alone.castRay(eye.translation, eye.rotation * *ray).has_value();
               });
  }
  return static_cast<double>(covered) / (kGridColumns * kGridRows);
}

}  // namespace camera_self_calibration
