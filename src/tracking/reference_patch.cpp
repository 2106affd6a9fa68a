#include "camera_self_calibration/tracking/reference_patch.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace camera_self_calibration {
namespace {

constexpr int kBlock = 4;  // Points side by side.

// Damping of a step, as the inverse square of a standard deviation at one gray value of noise: the
// linear part of the warp by 0.1, the shift by 1 px. It leaves the minimum where it is, and keeps
// directions that the patch does not determine (the scale of an ideal corner) from wandering.
constexpr double kShiftDamping = 1.0;
constexpr double kLinearDamping = 100.0;
constexpr double kPhotometricDamping = 1e-6;

double weightAt(int u, int v) {
  const double inside = 1.0 - (u * u + v * v) / (PatchPoints::kDiscRadius * PatchPoints::kDiscRadius);
  return inside > 0.0 ? inside * inside : 0.0;
}

}  // namespace

const PatchPoints& PatchPoints::get() {
  static const PatchPoints points;
  return points;
}

PatchPoints::PatchPoints() {
  u.fill(0.0f);
  v.fill(0.0f);
  weight.fill(0.0f);
  std::size_t n = 0;
  for (int y = -kRadius; y <= kRadius; ++y) {
    for (int x = -kRadius; x <= kRadius; ++x) {
      if (weightAt(x, y) <= 0.0) continue;
      u[n] = static_cast<float>(x);
      v[n] = static_cast<float>(y);
      weight[n] = static_cast<float>(weightAt(x, y));
      weight_sum += weight[n];
      ++n;
    }
  }
}

void ReferencePatch::cut(const cv::Mat& image, int x, int y) {
  constexpr int side = 2 * kRawRadius + 1;
  for (int row = 0; row < side; ++row) {
    const std::uint8_t* from = image.ptr<std::uint8_t>(y + row - kRawRadius) + x - kRawRadius;
    std::copy(from, from + side, raw_.data() + row * side);
  }
  blur_ = -1.0;
}

bool ReferencePatch::prepare(double blur) {
  constexpr int side = 2 * kRawRadius + 1;
  constexpr int margin = SmoothWindow::kKernelRadius;
  const cv::Mat image(side, side, CV_8UC1, raw_.data());
  SmoothWindow window;
  window.extract(image, cv::Rect(margin, margin, side - 2 * margin, side - 2 * margin), blur, blur);
  blur_ = blur;
  fillJacobian(window);
  return invertHessian();
}

void ReferencePatch::fillJacobian(const SmoothWindow& window) {
  const PatchPoints& points = PatchPoints::get();
  constexpr int centre = PatchPoints::kRadius + 1;
  alignas(16) std::array<float, PatchPoints::kCount> value, gradient_x, gradient_y;
  double sum = 0.0;
  for (std::size_t i = 0; i < PatchPoints::kCount; ++i) {
    const int x = centre + static_cast<int>(points.u[i]);
    const float* row = window.row(centre + static_cast<int>(points.v[i])) + x;
    const float* above = row - SmoothWindow::kMaxSide;
    const float* below = row + SmoothWindow::kMaxSide;
    // The cubic spline and its exact derivatives at a sample: [1 4 1] / 6 and [-1 0 1] / 2.
    const float left = (above[-1] + 4.0f * row[-1] + below[-1]) / 6.0f;
    const float middle = (above[0] + 4.0f * row[0] + below[0]) / 6.0f;
    const float right = (above[1] + 4.0f * row[1] + below[1]) / 6.0f;
    const float top = (above[-1] + 4.0f * above[0] + above[1]) / 6.0f;
    const float bottom = (below[-1] + 4.0f * below[0] + below[1]) / 6.0f;
    value[i] = (left + 4.0f * middle + right) / 6.0f;
    gradient_x[i] = 0.5f * (right - left);
    gradient_y[i] = 0.5f * (bottom - top);
    sum += points.weight[i] * value[i];
  }
  mean_ = static_cast<float>(sum / points.weight_sum);

  hessian_.setZero();
  squared_.setZero();
  for (std::size_t i = 0; i < PatchPoints::kCount; ++i) {
    const float gx = gradient_x[i], gy = gradient_y[i], u = points.u[i], v = points.v[i];
    Eigen::Matrix<float, kParameters, 1> j;
    j << gx, gy, gx * u, gy * u, gx * v, gy * v, value[i] - mean_, 1.0f;
    for (std::size_t k = 0; k < kParameters; ++k) {
      weighted_jacobian_[(i / kBlock * kParameters + k) * kBlock + i % kBlock] =
          points.weight[i] * j(static_cast<Eigen::Index>(k));
    }
    const Vector8d jd = j.cast<double>();
    const double w = points.weight[i];
    hessian_.noalias() += w * jd * jd.transpose();
    squared_.noalias() += w * w * jd * jd.transpose();
  }
  contrast_ = hessian_(6, 6) / points.weight_sum;
}

bool ReferencePatch::invertHessian() {
  Vector8d damping;
  damping << Eigen::Vector2d::Constant(kShiftDamping), Eigen::Vector4d::Constant(kLinearDamping),
      Eigen::Vector2d::Constant(kPhotometricDamping);
  Matrix8d damped = hessian_;
  damped.diagonal() += damping;
  const Eigen::LLT<Matrix8d> cholesky(damped);
  if (cholesky.info() != Eigen::Success) return false;
  damped_inverse_ = cholesky.solve(Matrix8d::Identity());
  const Matrix8d covariance = damped_inverse_ * squared_ * damped_inverse_;
  shift_covariance_ = covariance.topLeftCorner<2, 2>();
  return shift_covariance_.allFinite();
}

ReferencePatch::Vector8d ReferencePatch::project(const float* values) const {
  using Map = Eigen::Map<const Eigen::Array4f>;
  Eigen::Array<float, kBlock, kParameters> sums;
  sums.setZero();
  const float* jacobian = weighted_jacobian_.data();
  for (int i = 0; i < PatchPoints::kCount; i += kBlock, jacobian += kBlock * kParameters) {
    const Eigen::Array4f block = Map(values + i);
    for (int k = 0; k < kParameters; ++k) sums.col(k) += Map(jacobian + k * kBlock) * block;
  }
  return sums.matrix().colwise().sum().transpose().cast<double>();
}

}  // namespace camera_self_calibration
