#pragma once

#include <array>
#include <vector>

#include "camera_self_calibration/simulation/ray_tiles.h"
#include "camera_self_calibration/simulation/surface_view.h"

namespace camera_self_calibration {

/// A pixel in which more than one surface is seen.
struct EdgePixel {
  const RayTile& tile;
  const std::vector<SurfaceView>& views;
  const std::vector<int>& candidates;
  Eigen::Vector3f ray;            ///< Its centre.
  std::array<int, 4> at_corners;  ///< Surfaces seen at its corners.
};

/// Mean gray value over the pixel's area: exact for one straight edge between two surfaces, else
/// from 32 samples.
float grayOf(const EdgePixel& pixel);

/// Share of the unit square about the origin where `middle + u * x + v * y > 0`.
float shareOfSquare(float middle, float u, float v);

}  // namespace camera_self_calibration
