#include <Eigen/LU>

#include "batch_problem.h"
#include "camera_self_calibration/reference/batch.h"
#include "camera_self_calibration/reference/shared_marginal.h"
#include "input_check.h"

namespace camera_self_calibration {
namespace {

// Each landmark of each segment is a cluster.
std::vector<int> landmarkClusters(const std::vector<BatchSegment>& segments) {
  std::vector<int> clusters;
  int first = 0;
  for (const BatchSegment& batch : segments) {
    for (const Observation& seen : batch.segment->observations) {
      clusters.push_back(first + seen.landmark);
    }
    first += static_cast<int>(batch.segment->landmarks.size());
  }
  return clusters;
}

}  // namespace

std::optional<Marginal> batchMarginal(const std::vector<BatchSegment>& segments,
                                      const Camera& camera, const BatchOptions& options) {
  if (!inputProblem(segments, camera).empty()) return std::nullopt;
  BatchOptions with_intrinsics = options;
  with_intrinsics.estimate_intrinsics = true;
  BatchProblem batch(segments, camera, with_intrinsics);
  if (!batch.usesIntrinsics()) return std::nullopt;
  const auto shared = sharedMarginal(batch.problem(), batch.freeBlocks(), camera.estimatedCount(),
                                     landmarkClusters(segments), options.threads);
  if (!shared) return std::nullopt;
  Marginal marginal;
  marginal.information = shared->covariance.inverse();  // Eq. (4)
  marginal.track_scores =
      marginal.information * shared->influence * marginal.information * shared->freedomFactor();
  marginal.cost = shared->cost;
  marginal.observations = shared->observations;
  marginal.variables = shared->variables;
  return marginal;
}

}  // namespace camera_self_calibration
