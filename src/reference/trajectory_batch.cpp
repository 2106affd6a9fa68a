#include "camera_self_calibration/reference/trajectory_batch.h"

#include <cmath>

#include "camera_self_calibration/estimation/entropy.h"
#include "camera_self_calibration/estimation/gate.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/queue/segment_fit.h"
#include "camera_self_calibration/reference/batch.h"

namespace camera_self_calibration {
namespace {

// A part with fewer does not hold together.
constexpr std::size_t kMinKeyframes = 5;
constexpr std::size_t kMinLandmarks = 20;

// Of the cost, about the number of observations: a small share of a sigma, and before the gates a
// share of one.
constexpr double kTolerance = 1e-7;
constexpr double kRoughTolerance = 1e-5;

std::vector<BatchSegment> gauged(std::vector<Segment>* segments, const Camera& camera) {
  std::vector<BatchSegment> batch;
  for (Segment& segment : *segments) {
    if (segment.keyframes.size() < kMinKeyframes || segment.landmarks.size() < kMinLandmarks) {
      continue;
    }
    const SegmentBlock block = freeBlock(&segment, camera);
    batch.push_back({&segment, block.fixed_keyframes, block.fixed_landmark, 1.0});
  }
  return batch;
}

// As fitSegment does between its rounds. Returns the largest sigma that was added.
double gate(const std::vector<BatchSegment>& batch, const Camera& camera) {
  double largest = 0.0;
  for (const BatchSegment& part : batch) {
    const SegmentBlock block{part.segment, part.fixed_keyframes, part.fixed_landmark, 1.0};
    largest = std::max(largest, gateSegment(block, camera).unexplained_sigma);
  }
  return largest;
}

void describe(const std::vector<BatchSegment>& batch, const BatchOptions& options,
              BatchEstimate* estimate) {
  const auto marginal = batchMarginal(batch, estimate->camera, options);
  const auto covariance = marginal ? marginal->robustCovariance() : std::nullopt;
  estimate->covariance = covariance.value_or(IntrinsicsMatrix());
  estimate->uncertainty = pixelUncertainty(estimate->camera, estimate->covariance);
  estimate->entropy = entropy(estimate->camera, estimate->covariance);
}

}  // namespace

BatchEstimate TrajectoryBatch::solve(const Camera& start, int threads) {
  BatchEstimate estimate;
  estimate.camera = start;
  estimate.keyframes = trajectory_.keyframes();
  std::vector<Segment> segments = trajectory_.parts();
  const SegmentFitOptions fit;  // the queue's gates
  BatchOptions options;
  options.huber = fit.huber;
  options.threads = threads;
  std::vector<BatchSegment> batch;
  for (int round = 0;; ++round) {
    batch = gauged(&segments, estimate.camera);
    if (batch.empty()) break;
    options.tolerance = round == fit.gating_rounds ? kTolerance : kRoughTolerance;
    estimate.converged = solveBatch(batch, &estimate.camera, options).converged;
    if (round == fit.gating_rounds) break;
    estimate.unexplained_sigma =
        std::hypot(estimate.unexplained_sigma, gate(batch, estimate.camera));
  }
  for (const BatchSegment& part : batch) {
    estimate.stamp_ns = std::max(estimate.stamp_ns, part.segment->endNs());
    estimate.observations += static_cast<int>(part.segment->observations.size());
  }
  describe(batch, options, &estimate);
  trajectory_.update(segments);
  return estimate;
}

}  // namespace camera_self_calibration
