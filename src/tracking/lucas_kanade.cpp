#include "camera_self_calibration/tracking/lucas_kanade.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "camera_self_calibration/base/cpu_clones.h"

namespace camera_self_calibration {
namespace {

constexpr int kSide = LucasKanade::kSide;
constexpr int kRows = LucasKanade::kRows;
constexpr float kHalf = 0.5f * (kSide - 1);
// Of the mean square gradient along the direction that has least [gray^2/px^2].
constexpr float kMinGradient = 0.1f;
// Two steps that cancel but for this [px] go back and forth.
constexpr float kToAndFro = 0.01f;

// Between the pixels: kSide columns of `rows` rows, `right` and `down` of a pixel beyond p.
SELFCAL_CPU_CLONES void interpolate(const std::uint8_t* p, std::ptrdiff_t stride, float right,
                                    float down, int rows, float* __restrict out) {
  float above[kSide], below[kSide];
  for (int c = 0; c < kSide; ++c) above[c] = p[c] + right * (p[c + 1] - p[c]);
  for (int r = 0; r < rows; ++r) {
    p += stride;
    for (int c = 0; c < kSide; ++c) below[c] = p[c] + right * (p[c + 1] - p[c]);
    for (int c = 0; c < kSide; ++c) out[c] = above[c] + down * (below[c] - above[c]);
    for (int c = 0; c < kSide; ++c) above[c] = below[c];
    out += kSide;
  }
}

float sumOf(const float* lanes) {
  float sum = 0.0f;
  for (int c = 0; c < kSide; ++c) sum += lanes[c];
  return sum;
}

// Scharr's derivatives of the rows but the first and the last, and the sums of their products by
// columns: xx, xy, yy. The outer columns have none.
SELFCAL_CPU_CLONES void differentiate(const float* patch, float* __restrict dx,
                                      float* __restrict dy, float* __restrict sums) {
  float inner[kSide];
  for (int c = 0; c < kSide; ++c) inner[c] = c == 0 || c == kSide - 1 ? 0.0f : 1.0f / 32.0f;
  for (int k = 0; k < 3 * kSide; ++k) sums[k] = 0.0f;
  for (int r = 0; r < kRows; ++r) {
    const float* a = patch + r * kSide;
    const float* m = a + kSide;
    const float* b = m + kSide;
    for (int c = 0; c < kSide; ++c) {
      const float x =
          3.0f * (a[c + 1] - a[c - 1] + b[c + 1] - b[c - 1]) + 10.0f * (m[c + 1] - m[c - 1]);
      const float y = 3.0f * (b[c - 1] - a[c - 1] + b[c + 1] - a[c + 1]) + 10.0f * (b[c] - a[c]);
      dx[c] = x * inner[c];
      dy[c] = y * inner[c];
      sums[c] += dx[c] * dx[c];
      sums[kSide + c] += dx[c] * dy[c];
      sums[2 * kSide + c] += dy[c] * dy[c];
    }
    dx += kSide;
    dy += kSide;
  }
}

// What the image at p lacks of the window's gray, times the window's derivatives; by columns.
SELFCAL_CPU_CLONES void misfit(const std::uint8_t* p, std::ptrdiff_t stride, float right,
                               float down, const float* window, const float* dx, const float* dy,
                               float* __restrict sums) {
  float above[kSide], below[kSide];
  for (int k = 0; k < 2 * kSide; ++k) sums[k] = 0.0f;
  for (int c = 0; c < kSide; ++c) above[c] = p[c] + right * (p[c + 1] - p[c]);
  for (int r = 0; r < kRows; ++r) {
    p += stride;
    for (int c = 0; c < kSide; ++c) below[c] = p[c] + right * (p[c + 1] - p[c]);
    for (int c = 0; c < kSide; ++c) {
      const float difference = window[c] - (above[c] + down * (below[c] - above[c]));
      sums[c] += difference * dx[c];
      sums[kSide + c] += difference * dy[c];
    }
    for (int c = 0; c < kSide; ++c) above[c] = below[c];
    window += kSide;
    dx += kSide;
    dy += kSide;
  }
}

// The first of kSide + 1 pixels of `rows` + 1 rows around a point, and how far the point lies
// beyond it; null where they leave the image with its border.
const std::uint8_t* cornerOf(const cv::Mat& image, const cv::Point2f& point, int rows, float* right,
                             float* down) {
  const float x = point.x - kHalf;
  const float y = point.y - 0.5f * static_cast<float>(rows - 1);
  const float left = std::floor(x);
  const float top = std::floor(y);
  constexpr auto border = static_cast<float>(ImagePyramid::kBorder);
  // Written so that what is not a number fails.
  const bool inside = left >= -border && top >= -border &&
                      left + kSide < static_cast<float>(image.cols) + border &&
                      top + static_cast<float>(rows) < static_cast<float>(image.rows) + border;
  if (!inside) return nullptr;
  *right = x - left;
  *down = y - top;
  return image.data + static_cast<std::ptrdiff_t>(top) * static_cast<std::ptrdiff_t>(image.step) +
         static_cast<std::ptrdiff_t>(left);
}

}  // namespace

// False where there is too little texture to follow.
bool LucasKanade::setWindow(const cv::Mat& image, float gain, const cv::Point2f& point) {
  float right, down;
  const std::uint8_t* corner = cornerOf(image, point, kSide, &right, &down);
  if (corner == nullptr) return false;
  float* patch = patch_.data() + kSide;
  interpolate(corner, static_cast<std::ptrdiff_t>(image.step), right, down, kSide, patch);
  if (gain != 1.0f) {
    for (float& value : patch_) value *= gain;
  }
  alignas(32) float sums[3 * kSide];
  differentiate(patch, gradient_x_.data(), gradient_y_.data(), sums);
  xx_ = sumOf(sums);
  xy_ = sumOf(sums + kSide);
  yy_ = sumOf(sums + 2 * kSide);
  const float spread = std::sqrt((xx_ - yy_) * (xx_ - yy_) + 4.0f * xy_ * xy_);
  return 0.5f * (xx_ + yy_ - spread) > kMinGradient * kRows * kRows;
}

// False where the window leaves the image.
bool LucasKanade::seek(const cv::Mat& image, const Effort& effort, cv::Point2f* position) const {
  const float inverse = 1.0f / (xx_ * yy_ - xy_ * xy_);
  const float* window = patch_.data() + 2 * kSide;
  cv::Point2f last(0.0f, 0.0f);
  for (int i = 0; i < effort.iterations; ++i) {
    float right, down;
    const std::uint8_t* corner = cornerOf(image, *position, kRows, &right, &down);
    if (corner == nullptr) return false;
    alignas(32) float sums[2 * kSide];
    misfit(corner, static_cast<std::ptrdiff_t>(image.step), right, down, window, gradient_x_.data(),
           gradient_y_.data(), sums);
    const float x = sumOf(sums);
    const float y = sumOf(sums + kSide);
    const cv::Point2f step(inverse * (yy_ * x - xy_ * y), inverse * (xx_ * y - xy_ * x));
    *position += step;
    if (step.dot(step) <= effort.step * effort.step) break;
    const cv::Point2f both = step + last;
    if (i > 0 && std::abs(both.x) < kToAndFro && std::abs(both.y) < kToAndFro) {
      *position -= 0.5f * step;
      break;
    }
    last = step;
  }
  return true;
}

bool LucasKanade::follow(const ImagePyramid& from, float gain, const cv::Point2f& point,
                         const ImagePyramid& to, const Effort& effort, cv::Point2f* position) {
  bool found = false;
  for (int level = effort.coarsest_level; level >= 0; --level) {
    const float scale = std::ldexp(1.0f, -level);
    cv::Point2f there = scale * *position;
    // A coarse level without texture, or too near to the edge, leaves it to the finer ones.
    found =
        setWindow(from.level(level), gain, scale * point) && seek(to.level(level), effort, &there);
    if (found) *position = there / scale;
  }
  return found;
}

}  // namespace camera_self_calibration
