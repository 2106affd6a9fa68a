#pragma once

#include <Eigen/Core>
#include <array>

#include "camera_self_calibration/camera/image_field.h"

namespace camera_self_calibration {

/// How much each part of an image counts, on the grid of ImageField; at first nothing. A plain
/// value.
class ImageWeights {
 public:
  /// Of an image of this size [px].
  ImageWeights(int width, int height) : width_(width), height_(height) {}

  /// One more at the grid point that is nearest to the pixel.
  void count(const Eigen::Vector2d& pixel);

  double of(int column, int row) const { return weights_[index(column, row)]; }
  double sum() const;

  /// The smallest radius [px] about `centre` that holds at least `share` of the sum.
  double radiusHolding(double share, const Eigen::Vector2d& centre) const;

  /// Without what lies further from `centre` than `radius_px`.
  ImageWeights within(double radius_px, const Eigen::Vector2d& centre) const;
  /// Without what does not.
  ImageWeights beyond(double radius_px, const Eigen::Vector2d& centre) const;

 private:
  static std::size_t index(int column, int row) {
    return static_cast<std::size_t>(row * ImageField::kColumns + column);
  }
  double distance(std::size_t i, const Eigen::Vector2d& centre) const;

  int width_;
  int height_;
  std::array<float, ImageField::kColumns * ImageField::kRows> weights_{};
};

}  // namespace camera_self_calibration
