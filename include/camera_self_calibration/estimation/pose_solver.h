#pragma once

#include <Eigen/Core>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/map/inverse_depth.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// A pixel of a point whose place is known up to the map's scale.
struct PointView : WorldPoint {
  Eigen::Vector2d pixel;
  double sigma = 1.0;  ///< [px]
};

/// What keyframe `k` sees of landmarks that earlier keyframes determine; `camera`: the intrinsics
/// that are being estimated.
std::vector<PointView> earlierPointsSeenIn(int k, const Segment& segment, const Camera& camera);

struct PoseEstimate {
  bool usable = false;  ///< All directions are determined, and most views can be predicted.
  Rigid3 world_from_camera;
  /// Of (translation in the world, rotation in the camera), given the points and intrinsics.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  int inliers = 0;              ///< Views within 3.5 scaled sigma, or 1 px.
  double residual_scale = 1.0;  ///< Robust (median), of all views' whitened residuals; at least 1.
};

/// The pose alone, points and intrinsics held (eq. 2 with Huber weights), from `guess`.
PoseEstimate solvePose(const Camera& camera, const std::vector<PointView>& views,
                       const Rigid3& guess, double huber = kHuberThreshold,
                       int max_iterations = 10);

}  // namespace camera_self_calibration
