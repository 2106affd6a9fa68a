#include "pixel_grid.h"

namespace camera_self_calibration {

std::vector<PixelRay> pixelGrid(const Camera& camera, double max_radius_px) {
  constexpr int kColumns = 40;
  constexpr int kRows = 30;
  std::vector<PixelRay> grid;
  grid.reserve(kColumns * kRows);
  const Eigen::Vector2d centre = camera.parameters().segment<2>(2);
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Eigen::Vector2d pixel(column * (camera.width() - 1) / (kColumns - 1.0),
                                  row * (camera.height() - 1) / (kRows - 1.0));
      if ((pixel - centre).norm() > max_radius_px) continue;
      if (const auto ray = camera.unproject(pixel)) grid.push_back({pixel, *ray});
    }
  }
  return grid;
}

}  // namespace camera_self_calibration
