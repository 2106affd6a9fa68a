#include "camera_self_calibration/camera/pixel_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/camera/pixel_difference.h"
#include "camera_self_calibration/camera/pixel_grid.h"
#include "camera_self_calibration/camera/rotation_compensation.h"

namespace camera_self_calibration {

std::vector<UncertainPixel> uncertaintyOverImage(const Camera& camera,
                                                 const IntrinsicsMatrix& covariance,
                                                 const ImageField& field) {
  const int n = camera.estimatedCount();
  if (covariance.rows() != n || covariance.cols() != n || !covariance.allFinite()) return {};
  const CompensatedGrid grid = compensatedGrid(camera, pixelGrid(camera, field));
  std::vector<UncertainPixel> result;
  for (const CompensatedPixel& point : grid.points) {
    const double trace = (point.a * covariance).cwiseProduct(point.a).sum();
    result.push_back({point.pixel, std::sqrt(std::max(0.0, trace))});
  }
  return result;
}

IntrinsicsMatrix pixelMetric(const Camera& camera, const ImageField& field) {
  return compensatedGrid(camera, pixelGrid(camera, field)).metric();
}

PixelError pixelUncertainty(const Camera& camera, const IntrinsicsMatrix& covariance,
                            const ImageField& field) {
  const std::vector<UncertainPixel> grid = uncertaintyOverImage(camera, covariance, field);
  if (grid.empty()) return PixelError::unknown();
  PixelError error;
  double sum = 0.0;
  for (const UncertainPixel& point : grid) {
    sum += point.sigma * point.sigma;
    error.max = std::max(error.max, point.sigma);
  }
  error.rms = std::sqrt(sum / static_cast<double>(grid.size()));
  return error;
}

PixelError pixelDistance(const Camera& a, const Camera& b, double max_radius_px) {
  return bestRotation(pixelGrid(a, {}, max_radius_px), b).error;
}

PixelError pixelDistance(const Camera& a, const Camera& b, const ImageField& field) {
  return bestRotation(pixelGrid(a, field), b).error;
}

PixelDifference pixelDifference(const Camera& a, const Camera& b, double max_radius_px) {
  const std::vector<PixelRay> area = areaGrid(a, max_radius_px);
  const BestRotation best = bestRotation(area, b);
  PixelDifference difference;
  difference.error = best.error;
  difference.rotation_deg = best.rotation.angularDistance(Eigen::Quaterniond::Identity()) / kDegree;
  const auto compare = [&](const std::vector<PixelRay>& grid, auto* points) {
    for (const PixelRay& point : grid) {
      Eigen::Vector2d pixel;
      if (!b.project(best.rotation * point.ray, &pixel)) continue;
      points->push_back({point.pixel, pixel - point.pixel});
    }
    return static_cast<int>(grid.size() - points->size());
  };
  compare(area, &difference.samples);
  difference.refused = compare(pixelGrid(a, {}, max_radius_px), &difference.points);
  for (const PixelDifference::Point& point : difference.points) {
    difference.error.max = std::max(difference.error.max, point.offset.norm());
  }
  return difference;
}

}  // namespace camera_self_calibration
