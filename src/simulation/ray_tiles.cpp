#include "camera_self_calibration/simulation/ray_tiles.h"

#include <algorithm>

namespace camera_self_calibration {
namespace {

constexpr int kPixels = kTileSize * kTileSize;

// Mean difference between valid neighbours `step` apart in the tile's row-by-row order.
Eigen::Vector3f meanStep(const RayTile& tile, int step) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  int count = 0;
  for (int i = 0; i + step < kPixels; ++i) {
    const bool wraps = step == 1 && i % kTileSize == kTileSize - 1;
    const auto a = static_cast<std::size_t>(i);
    const auto b = static_cast<std::size_t>(i + step);
    if (wraps || !tile.valid[a] || !tile.valid[b]) continue;
    sum += tile.rays[b] - tile.rays[a];
    ++count;
  }
  return count > 0 ? Eigen::Vector3f(sum / static_cast<float>(count)) : sum;
}

RayTile makeTile(const Camera& camera, int x, int y) {
  RayTile tile;
  tile.x = x;
  tile.y = y;
  int valid = 0;
  for (int i = 0; i < kPixels; ++i) {
    const Eigen::Vector2d pixel(x + i % kTileSize, y + i / kTileSize);
    const auto index = static_cast<std::size_t>(i);
    tile.rays[index].setZero();
    if (!camera.inImage(pixel)) continue;
    const std::optional<Eigen::Vector3d> ray = camera.unproject(pixel);
    if (!ray) continue;
    tile.rays[index] = ray->cast<float>();
    tile.valid[index] = true;
    ++valid;
  }
  tile.any = valid > 0;
  tile.all = valid == kPixels;
  tile.d_column = meanStep(tile, 1);
  tile.d_row = meanStep(tile, kTileSize);
  // The corners of the outermost pixels lie less than one pixel beyond their centres.
  tile.cone = enclosingCone(&tile, 1, tile.d_column.norm() + tile.d_row.norm());
  return tile;
}

}  // namespace

RayTiles::RayTiles(const Camera& camera)
    : width(camera.width()),
      height(camera.height()),
      columns((width + kTileSize - 1) / kTileSize),
      rows((height + kTileSize - 1) / kTileSize) {
  tiles.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      tiles.push_back(makeTile(camera, column * kTileSize, row * kTileSize));
    }
  }
}

RayCone enclosingCone(const RayTile* tiles, int count, float margin) {
  const auto forEachRay = [&](const auto& visit) {
    for (int t = 0; t < count; ++t) {
      for (std::size_t i = 0; i < kPixels; ++i) {
        if (tiles[t].valid[i]) visit(tiles[t].rays[i]);
      }
    }
  };
  RayCone cone;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  forEachRay([&](const Eigen::Vector3f& ray) { sum += ray; });
  if (sum.norm() > 0.0f) cone.axis = sum.normalized();
  forEachRay([&](const Eigen::Vector3f& ray) {
    cone.chord = std::max(cone.chord, (ray - cone.axis).norm());
  });
  cone.chord += margin;
  return cone;
}

}  // namespace camera_self_calibration
