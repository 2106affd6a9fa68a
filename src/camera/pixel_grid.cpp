#include "camera_self_calibration/camera/pixel_grid.h"

namespace camera_self_calibration {

std::vector<PixelRay> pixelGrid(const Camera& camera, const ImageField& field,
                                double max_radius_px) {
  const Eigen::Vector2d centre = camera.parameters().segment<2>(2);
  const auto unproject = [&](const Eigen::Vector2d& pixel) {
    return (pixel - centre).norm() > max_radius_px ? std::nullopt : camera.unproject(pixel);
  };
  return pixelGrid(camera.width(), camera.height(), unproject, field);
}

std::vector<PixelRay> pixelGrid(const Camera& camera, const ImageWeights& weights) {
  std::vector<PixelRay> grid;
  for (int row = 0; row < ImageField::kRows; ++row) {
    for (int column = 0; column < ImageField::kColumns; ++column) {
      const double weight = weights.of(column, row);
      if (!(weight > 0.0)) continue;
      const Eigen::Vector2d pixel = ImageField::pixel(column, row, camera.width(), camera.height());
      if (const auto ray = camera.unproject(pixel)) grid.push_back({pixel, *ray, weight});
    }
  }
  return grid;
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
      if (const auto ray = unproject(pixel)) grid.push_back({pixel, *ray, 1.0});
    }
  }
  return grid;
}

std::vector<PixelRay> areaGrid(const Camera& camera, double max_radius_px) {
  constexpr int kColumns = 160;
  constexpr int kRows = 120;
  const Eigen::Vector2d centre = camera.parameters().segment<2>(2);
  std::vector<PixelRay> grid;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      // The corner of the image lies half a pixel before the centre of its first one.
      const Eigen::Vector2d pixel((column + 0.5) * camera.width() / kColumns - 0.5,
                                  (row + 0.5) * camera.height() / kRows - 0.5);
      if ((pixel - centre).norm() > max_radius_px) continue;
      if (const auto ray = camera.unproject(pixel)) grid.push_back({pixel, *ray, 1.0});
    }
  }
  return grid;
}

}  // namespace camera_self_calibration
