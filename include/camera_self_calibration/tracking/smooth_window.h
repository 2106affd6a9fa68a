#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>

#include "camera_self_calibration/tracking/float_block.h"

namespace camera_self_calibration {

/// A small rectangle of an image as a continuous function: gray values, blurred as asked, times the
/// cubic B-spline. The spline serves as the interpolation and as a blur at once: its moments up to
/// the third are the same at every sub-pixel position, so that, unlike with bilinear interpolation,
/// nothing pulls a registration towards or away from whole pixels.
class SmoothWindow {
 public:
  static constexpr int kMaxSide = 72;      ///< [px], whole blocks of floats.
  static constexpr int kKernelRadius = 3;  ///< Of the blur [px].
  static constexpr double kMaxBlur = 1.8;  ///< Largest variance of the blur per axis [px^2].
  static constexpr double kSplineBlur = 1.0 / 3.0;  ///< Variance of the spline itself [px^2].

  /// Takes the pixels x0 <= x < x0 + width (same in y), blurred by a kernel of the given variances.
  /// Beyond the image its edge repeats. False if the window is larger than kMaxSide.
  bool extract(const cv::Mat& image, const cv::Rect& window, double blur_x, double blur_y);

  /// Whether `sample` may be called for x and y: two pixels away from the window's edge.
  bool covers(const Eigen::Vector2f& low, const Eigen::Vector2f& high) const {
    return low.x() >= origin_.x() + 1.0f && low.y() >= origin_.y() + 1.0f &&
           high.x() < origin_.x() + static_cast<float>(width_ - 2) &&
           high.y() < origin_.y() + static_cast<float>(height_ - 2);
  }

  /// Coordinates of the window's first pixel in the image.
  const Eigen::Vector2f& origin() const { return origin_; }
  int width() const { return width_; }
  int height() const { return height_; }
  const float* row(int y) const { return pixels_.data() + y * kMaxSide; }

  /// Values at `count` points, whole blocks of floats, in image coordinates; all must be covered.
  void sample(const float* x, const float* y, int count, float* values) const;

 private:
  static constexpr int kPaddedSide = kMaxSide + 2 * kKernelRadius;

  int width_ = 0;
  int height_ = 0;
  Eigen::Vector2f origin_ = Eigen::Vector2f::Zero();
  alignas(16) std::array<float, kMaxSide * kMaxSide + 4> pixels_;
  alignas(16) std::array<float, kPaddedSide * kMaxSide> blurred_x_;
  alignas(16) std::array<float, wholeBlocks(kPaddedSide)> raw_row_;
};

}  // namespace camera_self_calibration
