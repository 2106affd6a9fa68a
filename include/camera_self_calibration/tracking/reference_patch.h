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
  static constexpr int kRadius = 7;           ///< Largest offset along an axis [px].
  static constexpr double kDiscRadius = 7.5;  ///< Where the weights reach zero [px].
  /// Points, whole blocks of floats; the last ones have no weight.
  static constexpr int kCount = 184;

  alignas(16) std::array<float, kCount> u;
  alignas(16) std::array<float, kCount> v;
  alignas(16) std::array<float, kCount> weight;
  float weight_sum = 0.0f;

  static const PatchPoints& get();

 private:
  PatchPoints();
};

/// What is kept of the image in which a corner was detected: the pixels around it, and all that
/// inverse-compositional registration precomputes from them. Parameters:
///  - the affine warp: shift (2) and linear part by columns (4);
///  - gain and offset;
///  - a change of blur, the coefficients of the second derivatives xx, xy, yy [px^2]: motion blur,
///    focus, foreshortening;
///  - the bending of the warp, the coefficients of u^2, u v, v^2 in x and in y [1/px]: what a wide
///    lens or a slanted surface does beyond the affine warp.
/// Change of blur and bending are known to be small, and held to that by a prior; left out, they
/// would displace the patch systematically.
class ReferencePatch {
 public:
  static constexpr int kWarp = 6;      ///< Parameters of the affine warp, the first ones.
  static constexpr int kGain = 6;      ///< Index of the gain.
  static constexpr int kBending = 11;  ///< Index of the first coefficient of the bending.
  static constexpr int kParameters = 17;
  static constexpr int kRawRadius = PatchPoints::kRadius + SmoothWindow::kKernelRadius + 1;
  using Matrix = Eigen::Matrix<double, kParameters, kParameters>;
  using Vector = Eigen::Matrix<double, kParameters, 1>;

  /// Levels of the pyramid from which a patch may be cut. On a coarser one it is as many pixels
  /// wide and shows more of the scene.
  static constexpr int kLevels = 2;

  /// Copies the pixels around (x, y), which lies at least kRawRadius inside `image`, that level of
  /// a pyramid. To be prepared before anything else is asked of it.
  void cut(const cv::Mat& image, int x, int y, int level = 0);
  int level() const { return level_; }

  /// Computes values, gradients and Hessian at a blur [px^2] beyond that of the spline, with priors
  /// for a variance of the difference between two patches of `noise` [gray^2]. False if the patch
  /// does not fix its position.
  bool prepare(double blur, double noise);

  /// Negative if not prepared.
  double blur() const { return blur_; }
  /// Weighted variance of the gray values.
  double contrast() const { return contrast_; }
  float mean() const { return mean_; }
  /// `J^T W J`.
  const Matrix& hessian() const { return hessian_; }
  /// D, diagonal: noise over the variances of the priors. The affine warp's linear part is held
  /// to that of the image before.
  const Vector& prior() const { return prior_; }
  /// `(J^T W J + D)^-1`.
  const Matrix& inverse() const { return inverse_; }
  /// Sets the anchor, the point of the patch that is tracked (offset from the centre [px]), to
  /// where the warp is determined best, within `reach` of the centre. An ideal corner looks the
  /// same at any scale: only its tip is known, and what lies beside it is not.
  void chooseAnchor(double reach);
  const Eigen::Vector2d& anchor() const { return anchor_; }

  /// Covariance of the anchor [px^2] for white noise of one gray value in the image.
  Eigen::Matrix2d anchorCovariance() const;

  /// Displacement of the anchor by the bending in a solution of gain 1.
  Eigen::Vector2d bendingAtAnchor(const Vector& solution) const;

  /// `J^T W values`, J the derivatives by the parameters; for values of PatchPoints::kCount points.
  Vector project(const float* values) const;

 private:
  void fillJacobian(const SmoothWindow& window);
  bool invertHessian();

  std::array<std::uint8_t, (2 * kRawRadius + 1) * (2 * kRawRadius + 1)> raw_;
  // Weighted derivatives, W J, a block of points side by side: [block][parameter][point].
  alignas(16) std::array<float, kParameters * PatchPoints::kCount> weighted_jacobian_;
  int level_ = 0;
  double blur_ = -1.0;
  double noise_ = 1.0;
  double contrast_ = 0.0;
  float mean_ = 0.0f;
  Matrix hessian_;
  Matrix squared_;  // J^T W^2 J: the covariance of J^T W noise.
  Vector prior_;
  Matrix inverse_;
  Eigen::Vector2d anchor_ = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, kWarp, kWarp> warp_covariance_;
};

}  // namespace camera_self_calibration
