#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

constexpr int kTileSize = 8;  ///< [px]

/// A cone of rays about a unit axis: every ray d of the cone has |d - axis| <= chord, so that
/// |m.d - m.axis| <= |m| chord for any vector m.
struct RayCone {
  Eigen::Vector3f axis = Eigen::Vector3f::UnitZ();
  float chord = 0.0f;
};

/// The unit rays of 8 x 8 pixels in the camera frame.
struct RayTile {
  int x = 0;  ///< First column [px].
  int y = 0;  ///< First row [px].
  RayCone cone;
  Eigen::Vector3f d_column = Eigen::Vector3f::Zero();       ///< Mean change of the ray per column.
  Eigen::Vector3f d_row = Eigen::Vector3f::Zero();          ///< Mean change of the ray per row.
  std::array<bool, kTileSize * kTileSize> valid{};          ///< In the image, and has a ray.
  std::array<Eigen::Vector3f, kTileSize * kTileSize> rays;  ///< Row by row.
  bool any = false;                                         ///< Any valid ray.
  bool all = false;  ///< All pixels that lie in the image have a ray, and the tile is complete.
};

/// The rays of all pixels of a camera, in tiles and in rows of blocks of tiles.
struct RayTiles {
  explicit RayTiles(const Camera& camera);

  int width = 0;               ///< Of the image [px].
  int height = 0;              ///< Of the image [px].
  int columns = 0;             ///< Of tiles.
  int rows = 0;                ///< Of tiles.
  std::vector<RayTile> tiles;  ///< Row by row.
};

/// A cone around those of several tiles; tiles without rays are skipped. Its chord is that of the
/// widest ray plus `margin`.
RayCone enclosingCone(const RayTile* tiles, int count, float margin);

}  // namespace camera_self_calibration
