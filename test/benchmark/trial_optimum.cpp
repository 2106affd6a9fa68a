#include "benchmark/trial_optimum.h"

#include <limits>
#include <utility>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/map/map.h"

namespace camera_self_calibration {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

void TrialOptimum::addKeyframe(const TrackedFrame& frame, const FeatureTracks& tracks) {
  frames_.push_back(frame);
  poses_.push_back(tracks.worldFromCamera(frame.stamp_ns));
  for (const Track& track : frame.tracks) {
    if (const auto point = tracks.point(track.id)) points_[track.id] = *point;
  }
}

// Conditions on nothing outside the span, as the queue's segments do.
Segment TrialOptimum::atTruth(const Span& span) const {
  Map map(static_cast<int>(frames_.size()));
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    if (frames_[k].stamp_ns < span.begin_ns || frames_[k].stamp_ns > span.end_ns) continue;
    Keyframe keyframe;
    keyframe.id = static_cast<std::int64_t>(k);
    keyframe.stamp_ns = frames_[k].stamp_ns;
    keyframe.world_from_camera = poses_[k];
    map.addKeyframe(keyframe, frames_[k].tracks, 1.0, truth_);
  }
  Segment segment = map.segmentFrom(0, truth_);
  for (Landmark& landmark : segment.landmarks) {
    const Rigid3& reference = segment.keyframes[landmark.reference].world_from_camera;
    const Eigen::Vector3d seen = reference.inverse() * points_.at(landmark.track_id);
    landmark.bearing = seen.normalized();
    landmark.inverse_depth = 1.0 / seen.norm();
  }
  return segment;
}

TrialOptimum::Result TrialOptimum::compare(const Camera& estimate,
                                           const std::vector<Span>& spans) const {
  Result result{kInfinity, kInfinity};
  std::vector<Segment> segments;
  for (const Span& span : spans) {
    Segment segment = atTruth(span);
    if (segment.keyframes.size() > 2) segments.push_back(std::move(segment));
  }
  if (segments.empty()) return result;
  SolverOptions options;
  options.max_iterations = 60;
  options.step_tolerance = 1e-4;
  options.cost_tolerance = 1e-8;
  Camera camera = truth_;
  camera.setEstimateK3(estimate.estimatedCount() == 9);
  Problem problem{&camera, true, {}};
  for (Segment& segment : segments) problem.blocks.push_back(freeBlock(&segment, camera));
  const SolveSummary best = solve(problem, options);
  if (!best.usable) return result;
  const auto covariance =
      covarianceFromInformation(marginalize(problem, options.huber).information);
  if (covariance) result.uncertainty_rms = pixelUncertainty(camera, *covariance).rms;
  Camera held = estimate;
  problem.camera = &held;
  problem.estimate_intrinsics = false;
  const SolveSummary there = solve(problem, options);
  if (there.usable) result.excess_cost = there.final_cost / best.final_cost - 1.0;
  return result;
}

}  // namespace camera_self_calibration
