#include "camera_self_calibration/tracking/reference_patch.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "camera_self_calibration/base/cpu_clones.h"
#include "camera_self_calibration/tracking/float_block.h"

namespace camera_self_calibration {
namespace {

// Standard deviations of the priors. That of the shift only damps a step.
constexpr double kShiftPrior = 1.0;    // [px]
constexpr double kLinearPrior = 0.04;  // [1]
// Over the life of a track, which is what its error depends on: the linear part's errors add up
// where the patch does not determine it.
constexpr double kLinearDoubt = 0.6;
constexpr double kPhotometricPrior = 1e3;  // Gain [1], offset [gray]: free.
constexpr double kBlurPrior = 0.5;         // [px^2]
// [1/px of the image] 140 degrees over 640 px bend by 1/f / 2.
constexpr double kBendingPrior = 0.002;

using Vector6d = Eigen::Matrix<double, 6, 1>;

// D of the class's comment, with a prior of its own for the linear part of the warp.
ReferencePatch::Vector priorOf(double linear, double noise, int level) {
  ReferencePatch::Vector sigma;
  sigma << Eigen::Vector2d::Constant(kShiftPrior), Eigen::Vector4d::Constant(linear),
      Eigen::Vector2d::Constant(kPhotometricPrior), Eigen::Vector3d::Constant(kBlurPrior),
      Vector6d::Constant(std::ldexp(kBendingPrior, level));
  return noise * sigma.cwiseAbs2().cwiseInverse();
}

double weightAt(int u, int v) {
  const double inside =
      1.0 - (u * u + v * v) / (PatchPoints::kDiscRadius * PatchPoints::kDiscRadius);
  return inside > 0.0 ? inside * inside : 0.0;
}

struct Derivatives {
  float value, x, y, xx, xy, yy;
};

// The cubic spline and its exact derivatives at a sample: [1 4 1] / 6, [-1 0 1] / 2, [1 -2 1].
Derivatives derivatives(const SmoothWindow& window, int u, int v) {
  constexpr int centre = PatchPoints::kRadius + 1;
  const float* row = window.row(centre + v) + centre + u;
  const float* above = row - SmoothWindow::kMaxSide;
  const float* below = row + SmoothWindow::kMaxSide;
  const float left = (above[-1] + 4.0f * row[-1] + below[-1]) / 6.0f;
  const float middle = (above[0] + 4.0f * row[0] + below[0]) / 6.0f;
  const float right = (above[1] + 4.0f * row[1] + below[1]) / 6.0f;
  const float top = (above[-1] + 4.0f * above[0] + above[1]) / 6.0f;
  const float centre_row = (row[-1] + 4.0f * row[0] + row[1]) / 6.0f;
  const float bottom = (below[-1] + 4.0f * below[0] + below[1]) / 6.0f;
  Derivatives d;
  d.value = (left + 4.0f * middle + right) / 6.0f;
  d.x = 0.5f * (right - left);
  d.y = 0.5f * (bottom - top);
  d.xx = left - 2.0f * middle + right;
  d.xy = 0.25f * (below[1] - below[-1] - above[1] + above[-1]);
  d.yy = top - 2.0f * centre_row + bottom;
  return d;
}

// A parameter's derivatives at a block of points begin here: [block][parameter][point].
constexpr int kBlockPitch = ReferencePatch::kParameters * kFloatBlock;

// out[k] = sum over the points of parameter k's derivative times the value; from one block of the
// values to the next it is `pitch`.
SELFCAL_CPU_CLONES void projectBlocks(const float* jacobian, const float* values, int pitch,
                                      float* out) {
  constexpr int parameters = ReferencePatch::kParameters;
  FloatBlock sums[parameters] = {};
  for (int i = 0; i < PatchPoints::kCount; i += kFloatBlock, values += pitch) {
    for (int k = 0; k < parameters; ++k, jacobian += kFloatBlock) {
      sums[k] += floatBlock(jacobian) * floatBlock(values);
    }
  }
  for (int k = 0; k < parameters; ++k) {
    out[k] = 0.0f;
    for (int j = 0; j < kFloatBlock; ++j) out[k] += sums[k][j];
  }
}

// `A^T B` of two such arrays, which is symmetric.
ReferencePatch::Matrix productOf(const float* a, const float* b) {
  Eigen::Matrix<float, ReferencePatch::kParameters, ReferencePatch::kParameters> product;
  for (int k = 0; k < ReferencePatch::kParameters; ++k) {
    projectBlocks(a, b + k * kFloatBlock, kBlockPitch, product.col(k).data());
  }
  return product.cast<double>().selfadjointView<Eigen::Lower>();
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

void ReferencePatch::cut(const cv::Mat& image, int x, int y, int level) {
  constexpr int side = 2 * kRawRadius + 1;
  for (int row = 0; row < side; ++row) {
    const std::uint8_t* from = image.ptr<std::uint8_t>(y + row - kRawRadius) + x - kRawRadius;
    std::copy(from, from + side, raw_.data() + row * side);
  }
  level_ = level;
  blur_ = -1.0;
  anchor_.setZero();
}

bool ReferencePatch::prepare(double blur, double noise) {
  constexpr int side = 2 * kRawRadius + 1;
  constexpr int margin = SmoothWindow::kKernelRadius;
  const cv::Mat image(side, side, CV_8UC1, raw_.data());
  SmoothWindow window;
  window.extract(image, cv::Rect(margin, margin, side - 2 * margin, side - 2 * margin), blur, blur);
  blur_ = blur;
  noise_ = noise;
  fillJacobian(window);
  return invertHessian();
}

void ReferencePatch::fillJacobian(const SmoothWindow& window) {
  const PatchPoints& points = PatchPoints::get();
  std::array<Derivatives, PatchPoints::kCount> at;
  double sum = 0.0;
  for (std::size_t i = 0; i < PatchPoints::kCount; ++i) {
    at[i] = derivatives(window, static_cast<int>(points.u[i]), static_cast<int>(points.v[i]));
    sum += points.weight[i] * at[i].value;
  }
  mean_ = static_cast<float>(sum / points.weight_sum);

  std::array<float, kParameters * PatchPoints::kCount> plain;
  for (std::size_t i = 0; i < PatchPoints::kCount; ++i) {
    const float u = points.u[i], v = points.v[i];
    const Derivatives& d = at[i];
    Eigen::Matrix<float, kParameters, 1> jacobian;
    jacobian << d.x, d.y, d.x * u, d.y * u, d.x * v, d.y * v,  // affine warp
        d.value - mean_, 1.0f,                                 // gain, offset
        d.xx, d.xy, d.yy,                                      // blur
        d.x * u * u, d.x * u * v, d.x * v * v,                 // bending
        d.y * u * u, d.y * u * v, d.y * v * v;
    const std::size_t first = i / kFloatBlock * kBlockPitch + i % kFloatBlock;
    for (int k = 0; k < kParameters; ++k) {
      const std::size_t at_k = first + static_cast<std::size_t>(k * kFloatBlock);
      plain[at_k] = jacobian(k);
      weighted_jacobian_[at_k] = points.weight[i] * jacobian(k);
    }
  }
  hessian_ = productOf(weighted_jacobian_.data(), plain.data());
  squared_ = productOf(weighted_jacobian_.data(), weighted_jacobian_.data());
  contrast_ = hessian_(kGain, kGain) / points.weight_sum;
}

bool ReferencePatch::invertHessian() {
  prior_ = priorOf(kLinearPrior, noise_, level_);
  Matrix sum = hessian_;
  sum.diagonal() += prior_;
  const Eigen::LLT<Matrix> cholesky(sum);
  if (cholesky.info() != Eigen::Success) return false;
  inverse_ = cholesky.solve(Matrix::Identity());

  const Vector doubt = priorOf(kLinearDoubt, noise_, level_);
  sum = hessian_;
  sum.diagonal() += doubt;
  const Eigen::LLT<Matrix> doubtful(sum);
  if (doubtful.info() != Eigen::Success) return false;
  using Columns = Eigen::Matrix<double, kParameters, kWarp>;
  const Columns columns = doubtful.solve(Columns::Identity());
  Matrix scatter = squared_;
  scatter.diagonal() += doubt;
  warp_covariance_ = columns.transpose() * scatter * columns;
  return warp_covariance_.allFinite();
}

// The patch's displacement at an offset c is d + c_x L_1 + c_y L_2, with shift d and columns L of
// the linear part: the trace of its covariance is a parabola in c.
void ReferencePatch::chooseAnchor(double reach) {
  const auto trace = [this](int i, int j) {
    return warp_covariance_.block<2, 2>(2 * i, 2 * j).trace();
  };
  Eigen::Matrix2d curvature;
  curvature << trace(1, 1), trace(1, 2), trace(1, 2), trace(2, 2);
  const Eigen::Vector2d slope(trace(0, 1), trace(0, 2));
  anchor_ = -curvature.inverse() * slope;
  if (!anchor_.allFinite()) anchor_.setZero();
  if (anchor_.norm() > reach) anchor_ *= reach / anchor_.norm();
}

Eigen::Matrix2d ReferencePatch::anchorCovariance() const {
  Eigen::Matrix<double, 2, kWarp> at_anchor;
  at_anchor << Eigen::Matrix2d::Identity(), anchor_.x() * Eigen::Matrix2d::Identity(),
      anchor_.y() * Eigen::Matrix2d::Identity();
  return at_anchor * warp_covariance_ * at_anchor.transpose();
}

Eigen::Vector2d ReferencePatch::bendingAtAnchor(const Vector& solution) const {
  const Eigen::Vector3d squares(anchor_.x() * anchor_.x(), anchor_.x() * anchor_.y(),
                                anchor_.y() * anchor_.y());
  return {solution.segment<3>(kBending).dot(squares),
          solution.segment<3>(kBending + 3).dot(squares)};
}

ReferencePatch::Vector ReferencePatch::project(const float* values) const {
  Eigen::Matrix<float, kParameters, 1> sums;
  projectBlocks(weighted_jacobian_.data(), values, kFloatBlock, sums.data());
  return sums.cast<double>();
}

}  // namespace camera_self_calibration
