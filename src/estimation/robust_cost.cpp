#include "camera_self_calibration/estimation/robust_cost.h"

#include "camera_self_calibration/estimation/robust.h"

namespace camera_self_calibration {

double robustCost(const SegmentBlock& block, const Camera& camera, double huber,
                  Transfers* transfers) {
  const Segment& segment = *block.segment;
  double cost = block.inverse_depth_prior.cost(segment);
  predictObservations(segment, camera, transfers, [&](std::size_t o, const Eigen::Vector2d* pixel) {
    const Observation& observation = segment.observations[o];
    const double sigma = observation.sigma * block.sigma_scale;
    // Eq. (3), with Huber's loss
    cost += pixel == nullptr
                ? unpredictableCost(sigma, huber)
                : HuberLoss(((observation.pixel - *pixel) / sigma).squaredNorm(), huber).cost;
  });
  return cost;
}

double robustCost(const SegmentBlock& block, const Camera& camera, double huber) {
  Transfers transfers;
  return robustCost(block, camera, huber, &transfers);
}

}  // namespace camera_self_calibration
