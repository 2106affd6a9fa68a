#include "camera_self_calibration/camera/estimate_distance.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/camera/rotation_compensation.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

void addOffsets(const std::vector<PixelRay>& grid, const Camera& calibration,
                const Eigen::Quaterniond& rotation, EstimateDistance* distance) {
  double refused = 0.0;
  double sum = 0.0;
  for (const PixelRay& point : grid) {
    Eigen::Vector2d pixel;
    sum += point.weight;
    if (calibration.project(rotation * point.ray, &pixel)) {
      distance->points.push_back({point.pixel, pixel - point.pixel, point.weight});
    } else {
      refused += point.weight;
    }
  }
  distance->refused = sum > 0.0 ? refused / sum : 1.0;
}

// Mean of A'^T e over the grid.
Intrinsics slope(const CompensatedGrid& derivatives, const std::vector<PixelRay>& grid,
                 const Camera& calibration, const Eigen::Quaterniond& rotation) {
  Intrinsics sum = Intrinsics::Zero(derivatives.absorbed.cols());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    Eigen::Vector2d pixel;
    if (!calibration.project(rotation * grid[i].ray, &pixel)) continue;
    sum += grid[i].weight * derivatives.points[i].a.transpose() * (pixel - grid[i].pixel);
  }
  return sum / derivatives.weight;
}

void addAxis(const Eigen::Quaterniond& rotation, const CompensatedGrid& derivatives,
             const IntrinsicsMatrix& covariance, EstimateDistance* distance) {
  const Eigen::Vector2d across = logSo3(rotation).head<2>();
  const Eigen::Vector2d direction =
      across.norm() > 0.0 ? Eigen::Vector2d(across.normalized()) : Eigen::Vector2d::UnitX();
  const Intrinsics along = derivatives.absorbed.topRows<2>().transpose() * direction;
  distance->axis_deg = across.norm() / kDegree;
  distance->axis_sigma_deg = std::sqrt(std::max(0.0, along.dot(covariance * along))) / kDegree;
}

}  // namespace

EstimateDistance distanceFromEstimate(const Camera& estimate, const IntrinsicsMatrix& covariance,
                                      const Camera& calibration, const ImageWeights& weights) {
  EstimateDistance distance;
  const int n = estimate.estimatedCount();
  if (covariance.rows() != n || covariance.cols() != n || !covariance.allFinite()) return distance;
  const std::vector<PixelRay> grid = pixelGrid(estimate, weights);
  const CompensatedGrid derivatives = compensatedGrid(estimate, grid);
  const BestRotation best = bestRotation(grid, calibration);
  // A ray of the estimate's own projects in it.
  if (grid.empty() || derivatives.points.size() != grid.size()) return distance;
  addOffsets(grid, calibration, best.rotation, &distance);
  const IntrinsicsMatrix squares = derivatives.metric() * covariance;
  distance.offset.noise = std::sqrt(squares.trace());
  if (!std::isfinite(best.error.rms)) return distance;
  const Intrinsics g = slope(derivatives, grid, calibration, best.rotation);
  const double variance = 4.0 * g.dot(covariance * g) + 2.0 * (squares * squares).trace();
  distance.offset = {best.error.rms * best.error.rms, squares.trace(), variance};
  addAxis(best.rotation, derivatives, covariance, &distance);
  return distance;
}

}  // namespace camera_self_calibration
