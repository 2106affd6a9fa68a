#include "pixel_grid.h"

namespace camera_self_calibration {

std::vector<PixelRay> pixelGrid(const Camera& camera, double max_radius_px) {
  const Eigen::Vector2d centre = camera.parameters().segment<2>(2);
  return pixelGrid(camera.width(), camera.height(), [&](const Eigen::Vector2d& pixel) {
    return (pixel - centre).norm() > max_radius_px ? std::nullopt : camera.unproject(pixel);
  });
}

std::vector<PixelRay> pixelGrid(
    int width, int height,
    const std::function<std::optional<Eigen::Vector3d>(const Eigen::Vector2d&)>& unproject) {
  constexpr int kColumns = 40;
  constexpr int kRows = 30;
  std::vector<PixelRay> grid;
  grid.reserve(kColumns * kRows);
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Eigen::Vector2d pixel(column * (width - 1) / (kColumns - 1.0),
                                  row * (height - 1) / (kRows - 1.0));
      if (const auto ray = unproject(pixel)) grid.push_back({pixel, *ray});
    }
  }
  return grid;
}

}  // namespace camera_self_calibration
