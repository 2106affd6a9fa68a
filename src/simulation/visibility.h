#pragma once

#include <Eigen/Core>
#include <vector>

#include "camera_self_calibration/simulation/ray_tiles.h"
#include "camera_self_calibration/simulation/surface_view.h"

namespace camera_self_calibration {

constexpr int kNoSurface = -1;

/// Index of the nearest of the candidates along a ray, or kNoSurface.
int nearestSurface(const std::vector<SurfaceView>& views, const std::vector<int>& candidates,
                   const Eigen::Vector3f& ray);

/// Narrows the surfaces down to those that may be seen in a cone: those that may meet it and are
/// not behind one that fills it. `inside` is what was found for a wider cone, null for all
/// surfaces.
void findCandidates(const std::vector<SurfaceView>& views, const RayCone& cone,
                    const std::vector<int>* inside, std::vector<int>* candidates);

}  // namespace camera_self_calibration
