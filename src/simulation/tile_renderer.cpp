#include "tile_renderer.h"

#include <algorithm>

#include "edge_pixel.h"
#include "pixel_footprint.h"
#include "visibility.h"

namespace camera_self_calibration {

void TileRenderer::render(const RayTile& tile, const RowViews& views,
                          const std::vector<int>& candidates, float* gray) {
  if (views.front() != views.back()) {  // the rows' poses differ: the tile's cone decides nothing
    fillMixed(tile, views, candidates, gray);
    return;
  }
  findCandidates(*views[0], tile.cone, &candidates, &narrowed_);
  if (narrowed_.size() == 1 && tile.all) {
    const SurfaceView& view = (*views[0])[static_cast<std::size_t>(narrowed_[0])];
    if (view.cover(tile.cone) == SurfaceView::Cover::kAll) return fill(tile, view, gray);
  }
  fillMixed(tile, views, narrowed_, gray);
}

void TileRenderer::fill(const RayTile& tile, const SurfaceView& view, float* gray) {
  const PixelFootprint footprint(tile, view);
  for (std::size_t i = 0; i < tile.rays.size(); ++i) gray[i] = footprint.shade(tile.rays[i]);
}

void TileRenderer::fillMixed(const RayTile& tile, const RowViews& views,
                             const std::vector<int>& candidates, float* gray) {
  const Eigen::Vector3f half = 0.5f * (tile.d_column + tile.d_row);
  const Eigen::Vector3f cross = 0.5f * (tile.d_column - tile.d_row);
  for (std::size_t i = 0; i < tile.rays.size(); ++i) {
    gray[i] = 0.0f;
    if (!tile.valid[i]) continue;
    const std::vector<SurfaceView>& row = *views[i / kTileSize];
    const Eigen::Vector3f& ray = tile.rays[i];
    const auto seen = [&](const Eigen::Vector3f& d) { return nearestSurface(row, candidates, d); };
    const std::array<int, 4> corners = {seen(ray - half), seen(ray + cross), seen(ray - cross),
                                        seen(ray + half)};
    const int surface = seen(ray);
    if (std::any_of(corners.begin(), corners.end(), [&](int s) { return s != surface; })) {
      gray[i] = grayOf(EdgePixel{tile, row, candidates, ray, corners});
    } else if (surface != kNoSurface) {
      gray[i] = PixelFootprint(tile, row[static_cast<std::size_t>(surface)]).shade(ray);
    }
  }
}

}  // namespace camera_self_calibration
