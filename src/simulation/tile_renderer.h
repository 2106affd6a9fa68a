#pragma once

#include <array>
#include <vector>

#include "camera_self_calibration/simulation/ray_tiles.h"
#include "camera_self_calibration/simulation/surface_view.h"

namespace camera_self_calibration {

/// The views of the 8 pixel rows of a row of tiles: all the same for a global shutter, else one per
/// row (same surfaces in the same order in all).
using RowViews = std::array<const std::vector<SurfaceView>*, kTileSize>;

/// Colours tiles of pixels. Where one surface fills a tile no visibility is tested; a pixel that an
/// edge crosses is averaged over its area.
class TileRenderer {
 public:
  /// Gray values of the tile's pixels, row by row; 0 where there is no ray or no surface.
  /// `candidates` must hold all surfaces that may be seen in the tile's cone.
  void render(const RayTile& tile, const RowViews& views, const std::vector<int>& candidates,
              float* gray);

 private:
  static void fill(const RayTile& tile, const SurfaceView& view, float* gray);
  static void fillMixed(const RayTile& tile, const RowViews& views,
                        const std::vector<int>& candidates, float* gray);

  std::vector<int> narrowed_;
};

}  // namespace camera_self_calibration
