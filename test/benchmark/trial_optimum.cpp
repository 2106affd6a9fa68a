#include "benchmark/trial_optimum.h"

#include <limits>
#include <utility>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/estimation/gate.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/map/map.h"
#include "camera_self_calibration/map/segment_edit.h"

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

namespace {

SolverOptions thorough() {
  SolverOptions options;
  options.max_iterations = 60;
  options.precision = 1e-4;
  return options;
}

// Tracks at the very edge of a lens's domain, that one of two nearly equal lenses cannot predict at
// all. The system's gate drops them; a lens that cannot predict more than these few is wrong.
bool removeUnpredictable(const Problem& problem) {
  constexpr double kMaxShare = 0.02;
  constexpr double kFarOffPx = 45.0;
  std::vector<std::vector<int>> removed;
  double landmarks = 0.0, count = 0.0;
  for (const SegmentBlock& block : problem.blocks) {
    removed.push_back(grossMisfits(block, *problem.camera, 3.0, kFarOffPx));
    count += static_cast<double>(removed.back().size());
    landmarks += static_cast<double>(block.segment->landmarks.size());
  }
  if (count == 0.0 || count > kMaxShare * landmarks) return false;
  for (std::size_t i = 0; i < removed.size(); ++i) {
    removeLandmarks(removed[i], problem.blocks[i].segment);
  }
  return true;
}

}  // namespace

TrialOptimum::Result TrialOptimum::compare(const Camera& estimate,
                                           const std::vector<Span>& spans) const {
  Result result{kInfinity, kInfinity};
  std::vector<Segment> segments;
  for (const Span& span : spans) {
    Segment segment = atTruth(span);
    if (segment.keyframes.size() > 2) segments.push_back(std::move(segment));
  }
  if (segments.empty()) return result;
  Camera camera = truth_;
  camera.setEstimateK3(estimate.estimatedCount() == 9);
  for (bool again = true; again;) {
    Camera held = estimate;
    Problem problem{&camera, true, {}, {}};
    for (Segment& segment : segments) problem.blocks.push_back(freeBlock(&segment, camera));
    const SolveSummary best = solve(problem, thorough());
    if (!best.usable) return result;
    const Marginal marginal = marginalize(problem, thorough().huber);
    if (const auto covariance = covarianceFromInformation(marginal.information)) {
      result.uncertainty_rms = pixelUncertainty(camera, *covariance).rms;
    }
    problem.camera = &held;
    problem.estimate_intrinsics = false;
    const SolveSummary there = solve(problem, thorough());
    if (!there.usable) return result;
    result.excess_cost = there.final_cost / best.final_cost - 1.0;
    again = removeUnpredictable(problem);
  }
  return result;
}

}  // namespace camera_self_calibration
