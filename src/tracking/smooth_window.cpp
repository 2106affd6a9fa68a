#include "camera_self_calibration/tracking/smooth_window.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "camera_self_calibration/base/cpu_clones.h"
#include "camera_self_calibration/tracking/float_block.h"

namespace camera_self_calibration {
namespace {

using IntBlock = std::int32_t __attribute__((vector_size(kFloatBlock * sizeof(std::int32_t))));
using Four =
    float __attribute__((vector_size(4 * sizeof(float)), aligned(sizeof(float)), may_alias));

inline const Four& four(const float* first) { return *reinterpret_cast<const Four*>(first); }
inline Four& four(float* first) { return *reinterpret_cast<Four*>(first); }

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
    std::copy(row + x0, row + x0 + count, out);
  } else {
    for (int i = 0; i < count; ++i) out[i] = row[std::clamp(x0 + i, 0, image.cols - 1)];
  }
}

// out[i] = sum_k kernel[k] (in[i + k step] + in[i - k step]), whole blocks.
SELFCAL_CPU_CLONES void blurLine(const float* in, int step, const float* kernel, int count,
                                 float* out) {
  for (int i = 0; i < count; i += kFloatBlock) {
    const float* c = in + i;
    floatBlock(out + i) = kernel[0] * floatBlock(c) +
                          kernel[1] * (floatBlock(c + step) + floatBlock(c - step)) +
                          kernel[2] * (floatBlock(c + 2 * step) + floatBlock(c - 2 * step)) +
                          kernel[3] * (floatBlock(c + 3 * step) + floatBlock(c - 3 * step));
  }
}

// For some points the first of the 4 x 4 pixels around each, and the weights of their columns and
// rows.
struct Supports {
  static constexpr int kMax = 64;
  alignas(32) std::int32_t first[kMax];
  alignas(32) float columns[4][kMax];
  alignas(32) float rows[4][kMax];
};

// The cubic B-spline's weights of the four samples around points that are `t` beyond the second.
inline void splineWeights(const FloatBlock& t, float (*weights)[Supports::kMax], int at) {
  const FloatBlock s = 1.0f - t;
  floatBlock(weights[0] + at) = s * s * s * (1.0f / 6.0f);
  floatBlock(weights[1] + at) = (0.5f * t - 1.0f) * t * t + 2.0f / 3.0f;
  floatBlock(weights[2] + at) = (0.5f * s - 1.0f) * s * s + 2.0f / 3.0f;
  floatBlock(weights[3] + at) = t * t * t * (1.0f / 6.0f);
}

// At most Supports::kMax points.
SELFCAL_CPU_CLONES void sampleSpline(const float* pixels, const float* origin, const float* x,
                                     const float* y, int count, float* values) {
  constexpr int pitch = SmoothWindow::kMaxSide;
  Supports supports;
  for (int i = 0; i < count; i += kFloatBlock) {
    const FloatBlock in_x = floatBlock(x + i) - origin[0];
    const FloatBlock in_y = floatBlock(y + i) - origin[1];
    // Positive, since the point is covered: the conversion to int rounds down.
    const IntBlock column = __builtin_convertvector(in_x, IntBlock);
    const IntBlock row = __builtin_convertvector(in_y, IntBlock);
    const IntBlock first = (row - 1) * pitch + column - 1;
    std::memcpy(supports.first + i, &first, sizeof(first));
    splineWeights(in_x - __builtin_convertvector(column, FloatBlock), supports.columns, i);
    splineWeights(in_y - __builtin_convertvector(row, FloatBlock), supports.rows, i);
  }
  float sums[Supports::kMax][4];  // along y
  for (int i = 0; i < count; ++i) {
    const float* p = pixels + supports.first[i];
    four(sums[i]) = supports.rows[0][i] * four(p) + supports.rows[1][i] * four(p + pitch) +
                    supports.rows[2][i] * four(p + 2 * pitch) +
                    supports.rows[3][i] * four(p + 3 * pitch);
  }
  for (int i = 0; i < count; ++i) {
    values[i] = supports.columns[0][i] * sums[i][0] + supports.columns[1][i] * sums[i][1] +
                supports.columns[2][i] * sums[i][2] + supports.columns[3][i] * sums[i][3];
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
  // Whole blocks; what lies beyond the width is not looked at.
  const int columns = wholeBlocks(width_);
  for (int y = 0; y < height_ + 2 * r; ++y) {
    readRow(image, window.y + y - r, window.x - r, wholeBlocks(columns + 2 * r), raw_row_.data());
    blurLine(raw_row_.data() + r, 1, kernel_x.data(), columns, blurred_x_.data() + y * kMaxSide);
  }
  for (int y = 0; y < height_; ++y) {
    blurLine(blurred_x_.data() + (y + r) * kMaxSide, kMaxSide, kernel_y.data(), columns,
             pixels_.data() + y * kMaxSide);
  }
  return true;
}

void SmoothWindow::sample(const float* x, const float* y, int count, float* values) const {
  for (int i = 0; i < count; i += Supports::kMax) {
    sampleSpline(pixels_.data(), origin_.data(), x + i, y + i, std::min(count - i, Supports::kMax),
                 values + i);
  }
}

}  // namespace camera_self_calibration
