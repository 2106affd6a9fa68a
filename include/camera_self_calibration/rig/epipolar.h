#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "camera_self_calibration/rig/rig.h"
#include "camera_self_calibration/rig/rig_segment.h"

namespace camera_self_calibration {

/// One point of the scene in two cameras at one time.
struct SharedView {
  std::int64_t stamp_ns = 0;
  int from = 0;  ///< The camera that follows it,
  Eigen::Vector2d from_pixel = Eigen::Vector2d::Zero();
  int to = 0;  ///< and the other one.
  Eigen::Vector2d to_pixel = Eigen::Vector2d::Zero();
};

/// What a segment's cameras see of each other's landmarks.
std::vector<SharedView> sharedViews(const RigSegment& segment);

/// How far a view is from the epipolar line (a curve where the lens distorts) in the image of `to`,
/// to first order and with a sign [px]: with n the normal of the plane through both cameras and the
/// ray of `from`, `n . ray(pixel) = 0` on the line. Depth does not enter. Nothing where a pixel has
/// no ray or the two cameras are in one place.
std::optional<double> epipolarOffset(const Rig& rig, const SharedView& view);

}  // namespace camera_self_calibration
