#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "camera_self_calibration/geometry/rigid3.h"

namespace camera_self_calibration {

/// Where two keyframes see a point: unit rays, each in its own camera.
struct RayPair {
  Eigen::Vector3d first;
  Eigen::Vector3d second;
};

/// A relative pose, and inverse depths along the first rays, in units of one over the distance
/// between the two.
struct TwoViews {
  Rigid3 second_from_first;            ///< Its translation has unit length.
  std::vector<double> inverse_depths;  ///< Of each pair, positive; 0: none that the pose explains.
};

/// The essential matrix that most pairs agree with (Nister's five-point solver in RANSAC, OpenCV's)
/// and the one pose of its four that has the points in front of both cameras. `tolerance`: distance
/// from an epipolar line that still agrees, at unit focal length. Nothing if fewer than eight do.
/// The same for the same pairs.
std::optional<TwoViews> relateViews(const std::vector<RayPair>& pairs, double tolerance);

}  // namespace camera_self_calibration
