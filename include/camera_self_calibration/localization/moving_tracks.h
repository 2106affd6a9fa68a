#pragma once

#include <cstdint>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/pose_solver.h"
#include "camera_self_calibration/geometry/rigid3.h"

namespace camera_self_calibration {

/// A track in the present image, as the map knows its point.
struct TrackedPoint {
  std::int64_t track_id = 0;
  PointView view;
  bool depth_known = false;  ///< Else view.inverse_depth is a guess, and any depth will do.
};

/// The tracks that a rigid scene does not explain from this pose: whatever their depth where that
/// is not known, they are off by more than 5 times the median residual of the points whose depth
/// is, and by more than `min_px`. Nothing where fewer than 15 depths are known.
std::vector<std::int64_t> movingTracks(const Camera& camera, const Rigid3& world_from_camera,
                                       const std::vector<TrackedPoint>& points, double min_px);

}  // namespace camera_self_calibration
