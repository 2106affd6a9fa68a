#include "camera_self_calibration/startup/growth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "camera_self_calibration/estimation/gate.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/pose_solver.h"
#include "camera_self_calibration/estimation/rigid_gate.h"
#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/map/inverse_depth.h"
#include "camera_self_calibration/map/segment_edit.h"
#include "two_views.h"

namespace camera_self_calibration {
namespace {

// Until there are so many, poses are not known well enough to tell what moves.
constexpr int kTellingKeyframes = 3;
constexpr int kGatingRounds = 2;

void restartRunawayLandmarks(double max_ratio, Segment* segment) {
  const double typical = typicalInverseDepth(inverseDepths(*segment));
  for (Landmark& landmark : segment->landmarks) {
    if (!(landmark.inverse_depth > 0.0) || landmark.inverse_depth > max_ratio * typical) {
      landmark.inverse_depth = typical;
    }
  }
}

// A first pose and first depths for keyframe `k`.
void placeKeyframe(int k, const Camera& camera, Segment* segment) {
  auto& keyframes = segment->keyframes;
  Rigid3& pose = keyframes[k].world_from_camera;
  pose = keyframes[k - 1].world_from_camera;
  const std::vector<PointView> views = earlierPointsSeenIn(k, *segment, camera);
  const PoseEstimate solved =
      solvePose(segment->cameraOf(k, camera), views, pose, kHuberThreshold, 20);
  if (solved.usable) pose = solved.world_from_camera;
  const double inverse_depth = typicalInverseDepthFrom(pose.translation, views);
  for (Landmark& landmark : segment->landmarks) {
    if (landmark.reference == k) landmark.inverse_depth = inverse_depth;
  }
}

// No motion, unit depths, first rays.
void forget(const Camera& camera, Segment* segment) {
  for (Keyframe& keyframe : segment->keyframes) keyframe.world_from_camera = Rigid3();
  for (Landmark& landmark : segment->landmarks) landmark.inverse_depth = 1.0;
  for (const Observation& observation : segment->observations) {
    Landmark& landmark = segment->landmarks[observation.landmark];
    if (landmark.anchored || observation.keyframe != landmark.reference) continue;
    const Camera& seen_with = segment->cameraOf(observation.keyframe, camera);
    if (const auto ray = seen_with.unproject(observation.pixel)) landmark.bearing = *ray;
  }
}

// A part of a segment: some of its keyframes from the first on, some of its landmarks.
struct Part {
  Segment segment;
  std::vector<int> landmark_index;  // in the whole segment
};

// Without what a rigid scene does not explain, which may belong to it once more is known: there it
// gets the depth that fits it best.
Part rigidPart(const GrowthOptions& options, const Camera& camera, Segment* whole) {
  restartRunawayLandmarks(options.max_inverse_depth_ratio, whole);
  const std::vector<int> moving = nonRigidTracks(whole, camera);
  Part part;
  part.segment = *whole;
  part.landmark_index.resize(whole->landmarks.size());
  std::iota(part.landmark_index.begin(), part.landmark_index.end(), 0);
  removeLandmarks(moving, &part.segment);
  for (auto l = moving.rbegin(); l != moving.rend(); ++l) {
    part.landmark_index.erase(part.landmark_index.begin() + *l);
  }
  return part;
}

void solvePrefix(const GrowthOptions& options, Segment* prefix, Camera* camera) {
  const int k = static_cast<int>(prefix->keyframes.size()) - 1;
  SolverOptions solver;
  // A long batch moves little by one keyframe more.
  solver.max_iterations = k < 12 ? 12 : 6;
  solver.precision = kRoughPrecision;  // near enough for the next keyframe to start from
  Problem problem;
  problem.camera = camera;
  problem.estimate_intrinsics = k + 1 >= options.free_after_keyframes;
  problem.blocks = {freeBlock(prefix, *camera)};
  problem.prior = options.prior;
  SegmentBlock& block = problem.blocks.front();
  block.sigma_scale = provisionalScale(block, *camera);
  solve(problem, solver);
  restartRunawayLandmarks(options.max_inverse_depth_ratio, prefix);
}

// Keyframes that have grown so far, and what is known of them.
struct Growth {
  Segment segment;
  Camera camera;
  double cost = 0.0;

  // All of them jointly, once the last one is placed.
  void solve(const GrowthOptions& options);
  // A residual of two coordinates costs 1 on average.
  bool fits() const { return cost < static_cast<double>(segment.observations.size()); }
};

void Growth::solve(const GrowthOptions& options) {
  if (static_cast<int>(segment.keyframes.size()) <= kTellingKeyframes) {
    solvePrefix(options, &segment, &camera);
  }
  std::vector<int> solved;
  for (int round = 0; round < kGatingRounds; ++round) {
    Part part = rigidPart(options, camera, &segment);
    if (part.segment.observations.empty() || part.landmark_index == solved) break;
    solvePrefix(options, &part.segment, &camera);
    adoptPrefix(part.segment, part.landmark_index, &segment);
    solved = std::move(part.landmark_index);
  }
  cost = robustCost(freeBlock(&segment, camera), camera, kHuberThreshold);
}

// What the first two keyframes both see.
struct SharedLandmarks {
  std::vector<int> index;
  std::vector<RayPair> rays;
};

SharedLandmarks sharedByFirstTwo(const Segment& segment, const Camera& camera) {
  SharedLandmarks shared;
  for (const Observation& observation : segment.observations) {
    const Landmark& landmark = segment.landmarks[observation.landmark];
    if (observation.keyframe != 1 || landmark.reference != 0) continue;
    const auto second = segment.cameraOf(1, camera).unproject(observation.pixel);
    Eigen::Vector3d first;
    if (!second || !landmarkRay(segment.cameraOf(0, camera), landmark, &first, nullptr)) continue;
    shared.index.push_back(observation.landmark);
    shared.rays.push_back({first, *second});
  }
  return shared;
}

// Pose and depths of the first two keyframes from their epipolar geometry, with the inverse depths
// about 1; false where they have none.
bool placeFromTwoViews(const Camera& camera, Segment* segment) {
  const SharedLandmarks shared = sharedByFirstTwo(*segment, camera);
  const double focal = camera.parameters().head<2>().minCoeff();
  const auto views = relateViews(shared.rays, kGrossShare * camera.longerSide() / focal);
  if (!views) return false;
  std::vector<double> triangulated;
  for (const double inverse_depth : views->inverse_depths) {
    if (inverse_depth > 0.0) triangulated.push_back(inverse_depth);
  }
  const double typical = typicalInverseDepth(std::move(triangulated));
  for (std::size_t i = 0; i < shared.index.size(); ++i) {
    const double inverse_depth = views->inverse_depths[i];
    if (inverse_depth > 0.0) {
      segment->landmarks[shared.index[i]].inverse_depth = inverse_depth / typical;
    }
  }
  Rigid3 second_from_first = views->second_from_first;
  second_from_first.translation *= typical;
  segment->keyframes[1].world_from_camera =
      segment->keyframes[0].world_from_camera * second_from_first.inverse();
  return true;
}

// The same keyframes from another beginning, all that was known of them forgotten: where depths
// differ much, as in driving, no motion and equal depths are too far from the solution.
std::optional<Growth> grownFromTwoViews(const GrowthOptions& options, Growth growth) {
  forget(growth.camera, &growth.segment);
  if (!placeFromTwoViews(growth.camera, &growth.segment)) return std::nullopt;
  const int last = static_cast<int>(growth.segment.keyframes.size()) - 1;
  for (int k = 1; k < last; ++k) {
    std::vector<int> landmark_index;
    Growth part{prefixOf(growth.segment, k + 1, 1, &landmark_index), growth.camera};
    part.solve(options);
    adoptPrefix(part.segment, landmark_index, &growth.segment);
    placeKeyframe(k + 1, growth.camera, &growth.segment);
  }
  growth.solve(options);
  return growth;
}

}  // namespace

bool ranAway(const Camera& camera) {
  // Of the longer side: a lens that sees all around (2 pi) in a circle over a third of the image.
  constexpr double kShortestFocal = 0.05;
  return !camera.valid() ||
         camera.parameters().head<2>().minCoeff() < kShortestFocal * camera.longerSide();
}

double growByKeyframe(const GrowthOptions& options, int k, Segment* segment, Camera* camera) {
  placeKeyframe(k, *camera, segment);
  std::vector<int> landmark_index;
  Growth grown{prefixOf(*segment, k + 1, 1, &landmark_index), *camera};
  if (grown.segment.observations.empty()) return std::numeric_limits<double>::infinity();
  grown.solve(options);
  if (k == kTellingKeyframes && options.two_views && !grown.fits()) {
    auto other = grownFromTwoViews(options, {grown.segment, *camera});
    if (other && other->cost < grown.cost) grown = *std::move(other);
  }
  *camera = grown.camera;
  adoptPrefix(grown.segment, landmark_index, segment);
  return grown.cost;
}

double bootstrap(const GrowthOptions& options, Segment* segment, Camera* camera,
                 double give_up_above) {
  forget(*camera, segment);
  double cost = std::numeric_limits<double>::infinity();
  for (int k = 1; k < static_cast<int>(segment->keyframes.size()); ++k) {
    cost = growByKeyframe(options, k, segment, camera);
    const bool estimated = k + 1 >= options.free_after_keyframes;
    if (estimated && cost > give_up_above) break;
  }
  return cost;
}

}  // namespace camera_self_calibration
