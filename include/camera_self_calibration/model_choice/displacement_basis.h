#pragma once

#include <Eigen/Core>

namespace camera_self_calibration {

/// Smooth displacements of an image's pixels, for what a lens does beyond its model: products
/// P_i(x) P_j(y) of Legendre polynomials with 2 <= i + j <= kDegree, for each axis of the image by
/// itself, where x and y go from -1 to 1 over the image; and a shear. Left out is what every model
/// describes itself, a shift and a scale of each axis, and what no image shows, a rotation.
///
/// Degree 7 follows bumps of a quarter of the image's width.
class DisplacementBasis {
 public:
  static constexpr int kDegree = 7;
  /// Two for each polynomial, one along each axis, then the shear.
  static constexpr int kCount = (kDegree + 1) * (kDegree + 2) - 5;

  using Displacements = Eigen::Matrix<double, 2, kCount>;

  /// Of an image of this size [px].
  DisplacementBasis(int width, int height) : width_(width), height_(height) {}

  /// What each displacement does to a pixel [px]: one a column, at most 1 px within the image.
  Displacements at(const Eigen::Vector2d& pixel) const;

 private:
  int width_;
  int height_;
};

}  // namespace camera_self_calibration
