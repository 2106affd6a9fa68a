#include "camera_self_calibration/queue/queue_residuals.h"

#include "camera_self_calibration/estimation/transfer.h"

namespace camera_self_calibration {

std::vector<QueueResidual> queueResiduals(const std::vector<Candidate>& queue,
                                          const Camera& camera) {
  std::vector<QueueResidual> residuals;
  Transfers transfers;
  for (const Candidate& candidate : queue) {
    const Segment& segment = candidate.segment;
    predictObservations(
        segment, camera, &transfers, [&](std::size_t o, const Eigen::Vector2d* prediction) {
          if (prediction == nullptr) return;
          const Observation& seen = segment.observations[o];
          residuals.push_back({segment.sequence, seen.pixel, seen.pixel - *prediction, seen.sigma});
        });
  }
  return residuals;
}

}  // namespace camera_self_calibration
