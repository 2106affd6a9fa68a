#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>

#include "camera_self_calibration/tracking/smooth_window.h"

namespace camera_self_calibration {

/// The points of a patch, offsets (u, v) from its centre on the pixel grid, with weights that fall
/// smoothly to zero at the rim. The weights are round, so that what a lens does to the patch beyond
/// the affine warp pulls its centre as little as possible, and small in variance for that reason.
struct PatchPoints {
  static constexpr int kRadius = 7;          ///< Largest offset along an axis [px].
  static constexpr double kDiscRadius = 7.5;  ///< Where the weights reach zero [px].
  static constexpr int kCount = 180;  ///< Points, a multiple of 4; the last ones have no weight.

  alignas(16) std::array<float, kCount> u;
  alignas(16) std::array<float, kCount> v;
  alignas(16) std::array<float, kCount> weight;
  float weight_sum = 0.0f;

  static const PatchPoints& get();

 private:
  PatchPoints();
};

/// What is kept of the image in which a corner was detected: the pixels around it, and all that
/// inverse-compositional registration precomputes from them. Parameters, 8: shift (2), the linear
/// part of the warp by columns (4), gain, offset.
class ReferencePatch {
 public:
  static constexpr int kParameters = 8;
  static constexpr int kRawRadius = PatchPoints::kRadius + SmoothWindow::kKernelRadius + 1;
  using Matrix8d = Eigen::Matrix<double, kParameters, kParameters>;
  using Vector8d = Eigen::Matrix<double, kParameters, 1>;

  /// Copies the pixels around (x, y), which lies at least kRawRadius inside the image. To be
  /// prepared before anything else is asked of it.
  void cut(const cv::Mat& image, int x, int y);

  /// Computes values, gradients and Hessian at a blur [px^2] beyond that of the spline. False if
  /// the patch does not fix its position.
  bool prepare(double blur);

  /// Negative if not prepared.
  double blur() const { return blur_; }
  /// Weighted variance of the gray values.
  double contrast() const { return contrast_; }
  float mean() const { return mean_; }
  const Matrix8d& hessian() const { return hessian_; }
  const Matrix8d& dampedInverse() const { return damped_inverse_; }
  /// Covariance of the shift [px^2] for white noise of one gray value in the image.
  const Eigen::Matrix2d& shiftCovariance() const { return shift_covariance_; }

  /// `J^T W values`, J the 8 derivatives; for values of PatchPoints::kCount points.
  Vector8d project(const float* values) const;

 private:
  void fillJacobian(const SmoothWindow& window);
  bool invertHessian();

  std::array<std::uint8_t, (2 * kRawRadius + 1) * (2 * kRawRadius + 1)> raw_;
  // Weighted derivatives, four points of one parameter side by side: [block][parameter][4].
  alignas(16) std::array<float, kParameters * PatchPoints::kCount> weighted_jacobian_;
  double blur_ = -1.0;
  double contrast_ = 0.0;
  float mean_ = 0.0f;
  Matrix8d hessian_;
  Matrix8d squared_;  // J^T W^2 J
  Matrix8d damped_inverse_;
  Eigen::Matrix2d shift_covariance_;
};

}  // namespace camera_self_calibration
