#include "edge_pixel.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pixel_footprint.h"
#include "visibility.h"

namespace camera_self_calibration {
namespace {

constexpr int kSampleBits = 5;
constexpr std::size_t kSamples = 1 << kSampleBits;

// Offsets from the pixel's centre [px]: a Hammersley set, no two in one column or row.
struct Samples {
  std::array<float, kSamples> across{};
  std::array<float, kSamples> down{};

  constexpr Samples() {
    for (std::size_t i = 0; i < kSamples; ++i) {
      std::size_t reversed = 0;
      for (int bit = 0; bit < kSampleBits; ++bit) {
        reversed |= (i >> bit & 1) << (kSampleBits - 1 - bit);
      }
      across[i] = (static_cast<float>(i) + 0.5f) / kSamples - 0.5f;
      down[i] = (static_cast<float>(reversed) + 0.5f) / kSamples - 0.5f;
    }
  }
};
constexpr Samples kOffsets;

// A border plane of a surface as a line in the pixel: its side is middle + across x + down y.
struct Line {
  float middle = 0.0f;
  float across = 0.0f;
  float down = 0.0f;

  // Whether the line passes through the unit square about the pixel's centre.
  bool cuts() const { return std::abs(middle) < 0.5f * (std::abs(across) + std::abs(down)); }
};

// The line along which a surface ends in a pixel; nothing if it ends along none or several.
std::optional<Line> endOf(const EdgePixel& pixel, int surface) {
  const SurfaceView& view = pixel.views[static_cast<std::size_t>(surface)];
  std::optional<Line> end;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3f& plane = view.borders.col(i);
    const Line line{plane.dot(pixel.ray), plane.dot(pixel.tile.d_column),
                    plane.dot(pixel.tile.d_row)};
    if (!line.cuts()) continue;
    if (end) return std::nullopt;
    end = line;
  }
  return end;
}

float shadeAt(const EdgePixel& pixel, int surface, float across, float down) {
  const SurfaceView& view = pixel.views[static_cast<std::size_t>(surface)];
  const Eigen::Vector3f ray = pixel.ray + across * pixel.tile.d_column + down * pixel.tile.d_row;
  return PixelFootprint(pixel.tile, view).shade(ray);
}

// The surface `front` up to its end, `back` beyond, each shaded about the middle of its part.
float blend(const EdgePixel& pixel, int front, int back, const Line& end) {
  const float share = shareOfSquare(end.middle, end.across, end.down);
  const float length = std::max(1e-12f, std::hypot(end.across, end.down));
  const float x = 0.5f * end.across / length;
  const float y = 0.5f * end.down / length;
  const float rest = 1.0f - share;
  return share * shadeAt(pixel, front, rest * x, rest * y) +
         rest * shadeAt(pixel, back, -share * x, -share * y);
}

float inverseDistance(const EdgePixel& pixel, int surface) {
  return pixel.views[static_cast<std::size_t>(surface)].inverse_distance.dot(pixel.ray);
}

// The gray value if just two surfaces are seen and the nearer ends along one line.
std::optional<float> grayOfTwo(const EdgePixel& pixel) {
  const auto& corners = pixel.at_corners;
  const int a = corners[0];
  const auto other = std::find_if(corners.begin(), corners.end(), [a](int s) { return s != a; });
  if (other == corners.end() || a == kNoSurface || *other == kNoSurface) return std::nullopt;
  const int b = *other;
  for (const int s : corners) {
    if (s != a && s != b) return std::nullopt;
  }
  const bool a_is_nearer = inverseDistance(pixel, a) > inverseDistance(pixel, b);
  const int front = a_is_nearer ? a : b;
  const int back = a_is_nearer ? b : a;
  if (const auto end = endOf(pixel, front)) return blend(pixel, front, back, *end);
  return std::nullopt;
}

// Each surface is shaded once, at the middle of the samples that meet it, and weighted by their
// number.
float grayOfSamples(const EdgePixel& pixel) {
  std::array<int, kSamples> surface;
  for (std::size_t k = 0; k < kSamples; ++k) {
    surface[k] = nearestSurface(
        pixel.views, pixel.candidates,
        pixel.ray + kOffsets.across[k] * pixel.tile.d_column + kOffsets.down[k] * pixel.tile.d_row);
  }
  float sum = 0.0f;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const int id = surface[k];
    if (id == kNoSurface) continue;
    float across = 0.0f;
    float down = 0.0f;
    float count = 0.0f;
    for (std::size_t other = k; other < kSamples; ++other) {
      if (surface[other] != id) continue;
      surface[other] = kNoSurface;
      across += kOffsets.across[other];
      down += kOffsets.down[other];
      count += 1.0f;
    }
    sum += count / kSamples * shadeAt(pixel, id, across / count, down / count);
  }
  return sum;
}

}  // namespace

float shareOfSquare(float middle, float u, float v) {
  const float large = std::max(std::max(std::abs(u), std::abs(v)), 1e-12f);
  const float small = std::min(std::abs(u), std::abs(v));
  // Across the steeper direction the covered length is linear between 0 and 1 (clamped); along the
  // other one its mean is the difference of its integral.
  const float centre = middle / large + 0.5f;
  const float spread = small / large;
  if (spread < 1e-3f) return std::clamp(centre, 0.0f, 1.0f);
  const auto integral = [](float t) {
    const float inside = std::clamp(t, 0.0f, 1.0f);
    return 0.5f * inside * inside + std::max(t - 1.0f, 0.0f);
  };
  const float share =
      (integral(centre + 0.5f * spread) - integral(centre - 0.5f * spread)) / spread;
  return std::clamp(share, 0.0f, 1.0f);
}

float grayOf(const EdgePixel& pixel) {
  const std::optional<float> gray = grayOfTwo(pixel);
  return gray ? *gray : grayOfSamples(pixel);
}

}  // namespace camera_self_calibration
