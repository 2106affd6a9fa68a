#include "camera_self_calibration/startup/growth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
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

namespace camera_self_calibration {
namespace {

// Until there are so many, poses are not known well enough to tell what moves.
constexpr int kTellingKeyframes = 3;
constexpr int kGatingRounds = 2;

// The observations of keyframe k of landmarks that earlier keyframes determine.
std::vector<PointView> viewsOf(const Segment& segment, int k, const Camera& camera) {
  std::vector<PointView> views;
  for (const Observation& observation : segment.observations) {
    const Landmark& landmark = segment.landmarks[observation.landmark];
    if (observation.keyframe != k || landmark.reference >= k) continue;
    Eigen::Vector3d ray;
    const Camera& seen_with = segment.cameraOf(landmark.reference, camera);
    if (!landmarkRay(seen_with, landmark, &ray, nullptr)) continue;
    const Rigid3& reference = segment.keyframes[landmark.reference].world_from_camera;
    views.push_back({reference.rotation * ray, reference.translation, landmark.inverse_depth,
                     observation.pixel, observation.sigma});
  }
  return views;
}

double medianInverseDepthAt(const Segment& segment, int k, const Camera& camera) {
  std::vector<double> inverse_depths;
  for (const Observation& observation : segment.observations) {
    const Landmark& landmark = segment.landmarks[observation.landmark];
    Eigen::Vector3d ray;
    if (observation.keyframe != k || landmark.reference >= k ||
        !landmarkRay(segment.cameraOf(landmark.reference, camera), landmark, &ray, nullptr)) {
      continue;
    }
    inverse_depths.push_back(
        transferInverseDepth(segment.keyframes[landmark.reference].world_from_camera, ray,
                             landmark.inverse_depth, segment.keyframes[k].world_from_camera));
  }
  return typicalInverseDepth(std::move(inverse_depths));
}

void restartRunawayDepths(double max_ratio, Segment* segment) {
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
  const PoseEstimate solved =
      solvePose(camera, viewsOf(*segment, k, camera), pose, kHuberThreshold, 20);
  if (solved.usable) pose = solved.world_from_camera;
  const double inverse_depth = medianInverseDepthAt(*segment, k, camera);
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
    if (const auto ray = camera.unproject(observation.pixel)) landmark.bearing = *ray;
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
  restartRunawayDepths(options.max_inverse_depth_ratio, whole);
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
  solver.step_tolerance = 1e-2;
  solver.cost_tolerance = 1e-2;  // near enough for the next keyframe to start from
  Problem problem;
  problem.camera = camera;
  problem.estimate_intrinsics = k + 1 >= options.free_after_keyframes;
  problem.blocks = {freeBlock(prefix, *camera)};
  problem.prior = options.prior;
  SegmentBlock& block = problem.blocks.front();
  block.sigma_scale = provisionalScale(block, *camera);
  solve(problem, solver);
  restartRunawayDepths(options.max_inverse_depth_ratio, prefix);
}

}  // namespace

bool ranAway(const Camera& camera) {
  // Of the image width: a lens that sees all around (2 pi) in a circle over a third of the image.
  constexpr double kShortestFocal = 0.05;
  return !camera.valid() ||
         camera.parameters().head<2>().minCoeff() < kShortestFocal * camera.width();
}

double growByKeyframe(const GrowthOptions& options, int k, Segment* segment, Camera* camera) {
  placeKeyframe(k, *camera, segment);
  std::vector<int> landmark_index;
  Segment grown = prefixOf(*segment, k + 1, 1, &landmark_index);
  if (grown.observations.empty()) return std::numeric_limits<double>::infinity();
  if (k < kTellingKeyframes) solvePrefix(options, &grown, camera);
  std::vector<int> solved;
  for (int round = 0; round < kGatingRounds; ++round) {
    Part part = rigidPart(options, *camera, &grown);
    if (part.segment.observations.empty() || part.landmark_index == solved) break;
    solvePrefix(options, &part.segment, camera);
    adoptPrefix(part.segment, part.landmark_index, &grown);
    solved = std::move(part.landmark_index);
  }
  adoptPrefix(grown, landmark_index, segment);
  return robustCost(freeBlock(&grown, *camera), *camera, kHuberThreshold);
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
