#include "camera_self_calibration/queue/queue_residuals.h"

#include <algorithm>

#include "camera_self_calibration/estimation/transfer.h"

namespace camera_self_calibration {
namespace {

/// By landmark, what its own parameters and its share of the segment's poses leave of the noise:
/// poses take from each landmark in proportion to the freedom that it has.
std::vector<double> expectedSquares(const Segment& segment) {
  std::vector<double> measured(segment.landmarks.size(), 0.0);
  for (const Observation& seen : segment.observations) {
    measured[static_cast<std::size_t>(seen.landmark)] += 2.0;
  }
  std::vector<double> left(measured.size(), 0.0);
  double all = 0.0;
  for (std::size_t l = 0; l < left.size(); ++l) {
    const double own = segment.landmarks[l].anchored ? 1.0 : 3.0;
    if (measured[l] > own) left[l] = 1.0 - own / measured[l];
    all += left[l] * measured[l];
  }
  // Six for each keyframe; seven of them, frame and scale, are a matter of choice.
  const double poses = 6.0 * static_cast<double>(segment.keyframes.size()) - 7.0;
  const double share = all > poses ? 1.0 - std::max(0.0, poses) / all : 0.0;
  for (double& square : left) square *= share;
  return left;
}

}  // namespace

std::vector<QueueResidual> queueResiduals(const std::vector<Candidate>& queue,
                                          const Camera& camera) {
  std::vector<QueueResidual> residuals;
  Transfers transfers;
  for (const Candidate& candidate : queue) {
    const Segment& segment = candidate.segment;
    const std::vector<double> expected = expectedSquares(segment);
    predictObservations(
        segment, camera, &transfers, [&](std::size_t o, const Eigen::Vector2d* prediction) {
          if (prediction == nullptr) return;
          const Observation& seen = segment.observations[o];
          residuals.push_back({segment.sequence,
                               segment.keyframes[static_cast<std::size_t>(seen.keyframe)].stamp_ns,
                               seen.pixel, seen.pixel - *prediction, seen.sigma,
                               expected[static_cast<std::size_t>(seen.landmark)]});
        });
  }
  return residuals;
}

}  // namespace camera_self_calibration
