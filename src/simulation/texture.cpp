#include "camera_self_calibration/simulation/texture.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace camera_self_calibration {
namespace {

constexpr int kGranularity = 32;  // texture sizes are multiples, so that five levels halve evenly
constexpr int kMaxLevels = 6;
constexpr float kMaxSamples = 8.0f;       // along the long axis of a footprint
constexpr float kRound = 1.4f;            // footprints less oblong than this take one sample
constexpr float kVariance = 1.0f / 6.0f;  // of the filter, per squared length of an axis

// log2 of a positive float to 0.01: exponent and a parabola through the mantissa.
float fastLog2(float x) {
  std::uint32_t bits;
  std::memcpy(&bits, &x, sizeof(bits));
  const float exponent = static_cast<float>(static_cast<int>(bits >> 23) - 127);
  bits = (bits & 0x007fffffu) | 0x3f800000u;
  float mantissa;
  std::memcpy(&mantissa, &bits, sizeof(mantissa));
  return exponent + (mantissa - 1.0f) * (1.3465f - 0.3465f * (mantissa - 1.0f));
}

int roundUp(int size) { return (size + kGranularity - 1) / kGranularity * kGranularity; }

// Halves an image of even size with the filter [1 3 3 1] / 8 in both directions.
cv::Mat halve(const cv::Mat& image) {
  cv::Mat padded, filtered;
  cv::copyMakeBorder(image, padded, 1, 1, 1, 1, cv::BORDER_REPLICATE);
  const cv::Mat kernel = (cv::Mat_<float>(1, 4) << 0.125f, 0.375f, 0.375f, 0.125f);
  // Anchor 1: the filtered value at (x, y) rests on x - 1 ... x + 2.
  cv::sepFilter2D(padded, filtered, CV_8U, kernel, kernel, cv::Point(1, 1));
  cv::Mat half(image.rows / 2, image.cols / 2, CV_8UC1);
  for (int y = 0; y < half.rows; ++y) {
    const std::uint8_t* from = filtered.ptr<std::uint8_t>(2 * y + 1) + 1;
    std::uint8_t* to = half.ptr<std::uint8_t>(y);
    for (int x = 0; x < half.cols; ++x) to[x] = from[2 * x];
  }
  return half;
}

}  // namespace

Texture::Texture(const cv::Mat& image) {
  if (image.empty() || image.type() != CV_8UC1) {
    throw std::invalid_argument("a texture needs an image of 8-bit gray");
  }
  cv::Mat level = image;
  const cv::Size size(roundUp(image.cols), roundUp(image.rows));
  if (size != image.size()) cv::resize(image, level, size, 0.0, 0.0, cv::INTER_LINEAR);
  float scale = 1.0f;
  for (int i = 0; i < kMaxLevels; ++i, scale *= 0.5f) {
    levels_.push_back(makeLevel(level, scale));
    if (i + 1 < kMaxLevels) level = halve(level);
  }
}

Texture::Level Texture::makeLevel(const cv::Mat& image, float scale) {
  Level level;
  level.width = image.cols;
  level.height = image.rows;
  level.stride = image.cols + 2;
  level.scale = scale;
  level.data.resize(static_cast<std::size_t>(level.stride) *
                    static_cast<std::size_t>(image.rows + 2));
  cv::Mat padded(image.rows + 2, level.stride, CV_8UC1, level.data.data());
  cv::copyMakeBorder(image, padded, 1, 1, 1, 1, cv::BORDER_REPLICATE);
  return level;
}

float Texture::bilinear(const Level& level, float x, float y) {
  // In the padded level the centre of texel i is at i + 1.
  const float px = std::min(std::max(x, 0.0f), static_cast<float>(level.width)) + 0.5f;
  const float py = std::min(std::max(y, 0.0f), static_cast<float>(level.height)) + 0.5f;
  const int ix = static_cast<int>(px);
  const int iy = static_cast<int>(py);
  const float a = px - static_cast<float>(ix);
  const float b = py - static_cast<float>(iy);
  const std::uint8_t* p = level.data.data() + static_cast<std::ptrdiff_t>(iy) * level.stride + ix;
  const float p00 = p[0];
  const float p01 = p[1];
  const float p10 = p[level.stride];
  const float p11 = p[level.stride + 1];
  const float upper = p00 + a * (p01 - p00);
  const float lower = p10 + a * (p11 - p10);
  return upper + b * (lower - upper);
}

float Texture::sample(float x, float y, float level) const {
  const float finest = std::min(std::max(level, 0.0f), static_cast<float>(levels_.size() - 1));
  const int index = static_cast<int>(finest);
  const float blend = finest - static_cast<float>(index);
  const Level& fine = levels_[static_cast<std::size_t>(index)];
  const float value = bilinear(fine, x * fine.scale, y * fine.scale);
  if (blend < 0.01f) return value;
  const Level& coarse = levels_[static_cast<std::size_t>(index) + 1];
  return value + blend * (bilinear(coarse, x * coarse.scale, y * coarse.scale) - value);
}

// The footprint is an ellipse. Along its short axis the mip level smooths; along the long axis
// several samples do, spread so that the variance of the whole follows the ellipse. Every quantity
// but the number of samples is continuous in the footprint: jumps between neighbouring pixels
// would move corners.
float Texture::sampleFootprint(float x, float y, float x_u, float y_u, float x_v, float y_v) const {
  const float xx = x_u * x_u + x_v * x_v;
  const float xy = x_u * y_u + x_v * y_v;
  const float yy = y_u * y_u + y_v * y_v;
  const float mean = 0.5f * (xx + yy);
  const float spread = std::sqrt(0.25f * (xx - yy) * (xx - yy) + xy * xy);
  const float long2 = mean + spread;
  const float smoothed2 =
      std::max({(mean - spread) * kRound * kRound, long2 / (kMaxSamples * kMaxSamples), 1.0f});
  const float level = 0.5f * fastLog2(smoothed2);
  if (long2 <= smoothed2) return sample(x, y, 0.5f * fastLog2(std::max(long2, 1.0f)));
  const float count = std::max(2.0f, std::ceil(std::sqrt(long2 / smoothed2)));
  // Equal steps have the variance step^2 (count^2 - 1) / 12.
  const float step = std::sqrt(12.0f * kVariance * (long2 - smoothed2) / (count * count - 1.0f));
  float axis_x = xx > yy ? long2 - yy : xy;
  float axis_y = xx > yy ? xy : long2 - xx;
  const float scale = step / std::sqrt(axis_x * axis_x + axis_y * axis_y);
  axis_x *= scale;
  axis_y *= scale;
  float sum = 0.0f;
  for (float offset = -0.5f * (count - 1.0f); offset < 0.5f * count; offset += 1.0f) {
    sum += sample(x + offset * axis_x, y + offset * axis_y, level);
  }
  return sum / count;
}

}  // namespace camera_self_calibration
