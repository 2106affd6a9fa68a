#include "camera_self_calibration/tracking/smooth_window.h"

#include <algorithm>
#include <cstdint>

namespace camera_self_calibration {
namespace {

using Weights = Eigen::Array4f;

// Cubic B-spline: its four pieces, by powers of t.
alignas(16) constexpr float kSpline[4][4] = {{1.0f / 6.0f, 4.0f / 6.0f, 1.0f / 6.0f, 0.0f},
                                             {-0.5f, 0.0f, 0.5f, 0.0f},
                                             {0.5f, -1.0f, 0.5f, 0.0f},
                                             {-1.0f / 6.0f, 0.5f, -0.5f, 1.0f / 6.0f}};

// Weights of the four samples around a point, t beyond the second of them.
inline Weights splineWeights(float t) {
  using Map = Eigen::Map<const Weights, Eigen::Aligned16>;
  return ((Map(kSpline[3]) * t + Map(kSpline[2])) * t + Map(kSpline[1])) * t + Map(kSpline[0]);
}

// Half of a symmetric kernel, centre first: [b 1-2b b] three times, of the variance wanted. It
// stays positive and close to a Gaussian.
std::array<float, 4> blurKernel(double variance) {
  const double b = std::clamp(variance, 0.0, SmoothWindow::kMaxBlur) / 6.0;
  const double a = 1.0 - 2.0 * b;
  return {static_cast<float>(a * a * a + 6.0 * a * b * b),
          static_cast<float>(3.0 * a * a * b + 3.0 * b * b * b),
          static_cast<float>(3.0 * a * b * b), static_cast<float>(b * b * b)};
}

// A row of the image as floats from column x0 on, the edge repeated.
void readRow(const cv::Mat& image, int y, int x0, int count, float* out) {
  const std::uint8_t* row = image.ptr<std::uint8_t>(std::clamp(y, 0, image.rows - 1));
  if (x0 >= 0 && x0 + count <= image.cols) {
    for (int i = 0; i < count; ++i) out[i] = row[x0 + i];
  } else {
    for (int i = 0; i < count; ++i) out[i] = row[std::clamp(x0 + i, 0, image.cols - 1)];
  }
}

// out[i] = sum_k kernel[k] (in[i + k step] + in[i - k step])
void blurLine(const float* in, int step, const std::array<float, 4>& kernel, int count,
              float* out) {
  for (int i = 0; i < count; ++i) {
    const float* c = in + i;
    out[i] = kernel[0] * c[0] + kernel[1] * (c[step] + c[-step]) +
             kernel[2] * (c[2 * step] + c[-2 * step]) + kernel[3] * (c[3 * step] + c[-3 * step]);
  }
}

}  // namespace

bool SmoothWindow::extract(const cv::Mat& image, const cv::Rect& window, double blur_x,
                           double blur_y) {
  if (window.width > kMaxSide || window.height > kMaxSide) return false;
  constexpr int r = kKernelRadius;
  width_ = window.width;
  height_ = window.height;
  origin_ = Eigen::Vector2f(static_cast<float>(window.x), static_cast<float>(window.y));
  const std::array<float, 4> kernel_x = blurKernel(blur_x);
  const std::array<float, 4> kernel_y = blurKernel(blur_y);
  for (int y = 0; y < height_ + 2 * r; ++y) {
    readRow(image, window.y + y - r, window.x - r, width_ + 2 * r, raw_row_.data());
    blurLine(raw_row_.data() + r, 1, kernel_x, width_, blurred_x_.data() + y * kMaxSide);
  }
  for (int y = 0; y < height_; ++y) {
    blurLine(blurred_x_.data() + (y + r) * kMaxSide, kMaxSide, kernel_y, width_,
             pixels_.data() + y * kMaxSide);
  }
  return true;
}

void SmoothWindow::sample(const float* x, const float* y, int count, float* values) const {
  using Map = Eigen::Map<const Eigen::Array4f>;
  for (int i = 0; i < count; ++i) {
    // Positive, since the point is covered: the conversion to int rounds down.
    const float in_x = x[i] - origin_.x();
    const float in_y = y[i] - origin_.y();
    const int column = static_cast<int>(in_x);
    const int row = static_cast<int>(in_y);
    const Weights wx = splineWeights(in_x - static_cast<float>(column));
    const Weights wy = splineWeights(in_y - static_cast<float>(row));
    const float* p = pixels_.data() + (row - 1) * kMaxSide + column - 1;
    const Weights sums = wy[0] * Map(p) + wy[1] * Map(p + kMaxSide) +
                         wy[2] * Map(p + 2 * kMaxSide) + wy[3] * Map(p + 3 * kMaxSide);
    values[i] = (wx * sums).sum();
  }
}

}  // namespace camera_self_calibration
