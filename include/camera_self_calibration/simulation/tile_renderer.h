#pragma once

#include <array>
#include <vector>

#include "camera_self_calibration/simulation/ray_tiles.h"
#include "camera_self_calibration/simulation/surface_view.h"

namespace camera_self_calibration {

/// The views of the 8 pixel rows of a row of tiles: all the same for a global shutter, else one per
/// row (same surfaces in the same order in all).
using RowViews = std::array<const std::vector<SurfaceView>*, kTileSize>;

/// Colours tiles of pixels. Where one surface fills a tile no visibility is tested; where an edge
/// crosses a pixel, the surfaces are weighted by 16 samples of the pixel's area.
class TileRenderer {
 public:
  /// Narrows the surfaces down to those that may meet a cone; `inside` (indices into the views)
  /// is what was found for a wider cone, null for all surfaces.
  static void findCandidates(const std::vector<SurfaceView>& views, const RayCone& cone,
                             const std::vector<int>* inside, std::vector<int>* candidates);

  /// Gray values of the tile's pixels, row by row; 0 where there is no ray or no surface.
  /// `candidates` must hold all surfaces that may meet the tile's cone.
  void render(const RayTile& tile, const RowViews& views, const std::vector<int>& candidates,
              float* gray);

 private:
  void fill(const RayTile& tile, const RowViews& views, int surface, float* gray) const;
  void fillMixed(const RayTile& tile, const RowViews& views, const std::vector<int>& candidates,
                 float* gray);
  float supersample(const RayTile& tile, const std::vector<SurfaceView>& views,
                    const std::vector<int>& candidates, const Eigen::Vector3f& ray);

  std::vector<int> narrowed_;
};

}  // namespace camera_self_calibration
