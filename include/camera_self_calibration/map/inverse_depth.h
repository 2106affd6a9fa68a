#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>
#include <vector>

#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// A point of the scene in the world of a map, homogeneous up to its scale: seen from an observer
/// it lies in the direction `direction + inverse_depth * (origin - observer)` (eq. 1), which stays
/// finite for far points.
struct WorldPoint {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< Unit ray in the world.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();      ///< Where that ray begins [map unit].
  double inverse_depth = 0.0;                            ///< Along the ray [1/map unit].
};

/// From an observer to the point, not of unit length.
inline Eigen::Vector3d directionFrom(const WorldPoint& point, const Eigen::Vector3d& observer) {
  return point.direction + point.inverse_depth * (point.origin - observer);
}

/// One over the distance between an observer and the point, with the sign of its inverse depth
/// [1/map unit].
inline double inverseDistance(const WorldPoint& point, const Eigen::Vector3d& observer) {
  return point.inverse_depth / std::max(directionFrom(point, observer).norm(), 1e-9);
}

/// Inverse depth of a point along its own ray in another keyframe: `rho' = rho / |x|` with x as in
/// eq. 1.
double transferInverseDepth(const Rigid3& world_from_anchor, const Eigen::Vector3d& ray,
                            double inverse_depth, const Rigid3& world_from_other);

/// Linear triangulation: the inverse depth for which the rays to a point meet best. Each ray `seen`
/// of another camera asks for `seen x (rotated + rho translation) = 0`, with the point's own ray
/// and its camera's position as that camera sees them (eq. 1).
class RayIntersection {
 public:
  void add(const Eigen::Vector3d& seen, const Eigen::Vector3d& rotated,
           const Eigen::Vector3d& translation) {
    const Eigen::Vector3d by_depth = seen.cross(translation);
    product_ += by_depth.dot(seen.cross(rotated));
    square_ += by_depth.squaredNorm();
  }
  /// 0 where no ray tells it [1/map unit].
  double inverseDepth() const { return square_ > 0.0 ? -product_ / square_ : 0.0; }

 private:
  double product_ = 0.0;
  double square_ = 0.0;
};

/// Median size of inverse depths [1/map unit], positive; 1 if there are none. In rotation on the
/// spot half of them may be negative: a median that loses its sign would let the scale run away.
double typicalInverseDepth(std::vector<double> inverse_depths);

/// typicalInverseDepth() of a range of WorldPoint as seen from `observer`.
template <typename Points>
double typicalInverseDepthFrom(const Eigen::Vector3d& observer, const Points& points) {
  std::vector<double> inverse_depths;
  inverse_depths.reserve(points.size());
  for (const WorldPoint& point : points) inverse_depths.push_back(inverseDistance(point, observer));
  return typicalInverseDepth(std::move(inverse_depths));
}

/// Where a landmark of a segment is.
WorldPoint worldPoint(const Landmark& landmark, const Segment& segment);

/// Inverse depths of all landmarks, each in its own reference keyframe [1/map unit].
std::vector<double> inverseDepths(const Segment& segment);

/// Their median, with its sign; `fallback` without landmarks.
double medianInverseDepth(const Segment& segment, double fallback);

/// The landmarks that keyframe `k` sees, those that are anchored there among them.
std::vector<const Landmark*> landmarksSeenIn(int k, const Segment& segment);

/// typicalInverseDepth() of the landmarks that keyframe `k` sees, in its own frame.
double typicalInverseDepthAt(int k, const Segment& segment);

}  // namespace camera_self_calibration
