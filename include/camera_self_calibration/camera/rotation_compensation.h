#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/camera/pixel_grid.h"

namespace camera_self_calibration {

/// The rotation of the camera that brings b's projections of a grid's rays closest to its pixels
/// (weighted least squares), and what is left; unknown() where b projects none.
struct BestRotation {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  PixelError error = PixelError::unknown();
};
BestRotation bestRotation(const std::vector<PixelRay>& grid, const Camera& b);

/// Where in the image, and what the intrinsics do there that no rotation of the camera absorbs:
/// `A' = A - B (sum w B^T B)^-1 sum w B^T A`, 2 x n_c.
struct CompensatedPixel {
  Eigen::Vector2d pixel;
  PixelIntrinsicsJacobian a;
  double weight = 1.0;
};

struct CompensatedGrid {
  std::vector<CompensatedPixel> points;
  RayIntrinsicsJacobian absorbed;  ///< 3 x n_c: the rotation that is absorbed [rad per unit].
  double weight = 0.0;             ///< Sum over the points.

  /// Mean of A'^T A' (see pixelMetric).
  IntrinsicsMatrix metric() const;
};
CompensatedGrid compensatedGrid(const Camera& camera, const std::vector<PixelRay>& grid);

}  // namespace camera_self_calibration
