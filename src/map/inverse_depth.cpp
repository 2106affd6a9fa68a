#include "camera_self_calibration/map/inverse_depth.h"

#include <cmath>
#include <utility>

#include "camera_self_calibration/base/median.h"

namespace camera_self_calibration {

double transferInverseDepth(const Rigid3& world_from_anchor, const Eigen::Vector3d& ray,
                            double inverse_depth, const Rigid3& world_from_other) {
  const WorldPoint point{world_from_anchor.rotation * ray, world_from_anchor.translation,
                         inverse_depth};
  return inverseDistance(point, world_from_other.translation);
}

double typicalInverseDepth(std::vector<double> inverse_depths) {
  for (double& depth : inverse_depths) depth = std::abs(depth);
  const double middle = median(std::move(inverse_depths), 1.0);
  return middle > 0.0 ? middle : 1.0;
}

std::vector<double> inverseDepths(const Segment& segment) {
  std::vector<double> depths;
  depths.reserve(segment.landmarks.size());
  for (const Landmark& landmark : segment.landmarks) depths.push_back(landmark.inverse_depth);
  return depths;
}

double medianInverseDepth(const Segment& segment, double fallback) {
  return median(inverseDepths(segment), fallback);
}

}  // namespace camera_self_calibration
