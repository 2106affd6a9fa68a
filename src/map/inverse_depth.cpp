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
  for (double& value : inverse_depths) value = std::abs(value);
  const double middle = median(std::move(inverse_depths), 1.0);
  return middle > 0.0 ? middle : 1.0;
}

WorldPoint worldPoint(const Landmark& landmark, const Segment& segment) {
  const Rigid3& reference = segment.keyframes[landmark.reference].world_from_camera;
  return {reference.rotation * landmark.bearing, reference.translation, landmark.inverse_depth};
}

std::vector<double> inverseDepths(const Segment& segment) {
  std::vector<double> values;
  values.reserve(segment.landmarks.size());
  for (const Landmark& landmark : segment.landmarks) values.push_back(landmark.inverse_depth);
  return values;
}

double medianInverseDepth(const Segment& segment, double fallback) {
  return median(inverseDepths(segment), fallback);
}

std::vector<const Landmark*> landmarksSeenIn(int k, const Segment& segment) {
  std::vector<const Landmark*> seen;
  for (const Landmark& landmark : segment.landmarks) {
    if (landmark.anchored && landmark.reference == k) seen.push_back(&landmark);
  }
  for (const Observation& observation : segment.observations) {
    if (observation.keyframe == k) seen.push_back(&segment.landmarks[observation.landmark]);
  }
  return seen;
}

double typicalInverseDepthAt(int k, const Segment& segment) {
  std::vector<WorldPoint> points;
  for (const Landmark* landmark : landmarksSeenIn(k, segment)) {
    points.push_back(worldPoint(*landmark, segment));
  }
  return typicalInverseDepthFrom(segment.keyframes[k].world_from_camera.translation, points);
}

}  // namespace camera_self_calibration
