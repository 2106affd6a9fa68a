#include "pixel_grid.h"

namespace camera_self_calibration {

std::vector<PixelRay> pixelGrid(const Camera& camera, const ImageField& field,
                                double max_radius_px) {
  const Eigen::Vector2d centre = camera.parameters().segment<2>(2);
  const auto unproject = [&](const Eigen::Vector2d& pixel) {
    return (pixel - centre).norm() > max_radius_px ? std::nullopt : camera.unproject(pixel);
  };
  return pixelGrid(camera.width(), camera.height(), unproject, field);
}

std::vector<PixelRay> pixelGrid(
    int width, int height,
    const std::function<std::optional<Eigen::Vector3d>(const Eigen::Vector2d&)>& unproject,
    const ImageField& field) {
  std::vector<PixelRay> grid;
  grid.reserve(ImageField::kColumns * ImageField::kRows);
  for (int row = 0; row < ImageField::kRows; ++row) {
    for (int column = 0; column < ImageField::kColumns; ++column) {
      if (!field.sees(column, row)) continue;
      const Eigen::Vector2d pixel = ImageField::pixel(column, row, width, height);
      if (const auto ray = unproject(pixel)) grid.push_back({pixel, *ray});
    }
  }
  return grid;
}

}  // namespace camera_self_calibration
