#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace camera_self_calibration {

/// A gray image with its mip levels. Positions are continuous: texel (i, j) of the finest level
/// covers [i, i + 1] x [j, j + 1], so that its centre is at (i + 0.5, j + 0.5). All levels share
/// the middle of every texel exactly: filtering moves nothing.
class Texture {
 public:
  /// `image` is CV_8UC1; it is resized to the next multiple of 32 in each direction if needed.
  /// Throws std::invalid_argument for an empty image or another type.
  explicit Texture(const cv::Mat& image);

  int width() const { return levels_.front().width; }    ///< Of the finest level [texel].
  int height() const { return levels_.front().height; }  ///< Of the finest level [texel].
  int levels() const { return static_cast<int>(levels_.size()); }

  /// Gray value [0, 255] at a position on the finest level, interpolated within and between mip
  /// levels; `level` 0 is the finest, level k averages over about 2^k texels. Positions beyond the
  /// edge take its value.
  float sample(float x, float y, float level) const;

  /// Mean over the footprint of a pixel: the parallelogram spanned by the derivatives of the
  /// position along the image's columns (x_u, y_u) and rows (x_v, y_v) [texel/px]. Oblique views
  /// take several samples along the long side.
  float sampleFootprint(float x, float y, float x_u, float y_u, float x_v, float y_v) const;

 private:
  // One texel of margin all round, so that interpolation needs no test at the edge.
  struct Level {
    int width = 0;
    int height = 0;
    int stride = 0;
    float scale = 1.0f;  // texels of this level per texel of the finest
    std::vector<std::uint8_t> data;
  };

  static Level makeLevel(const cv::Mat& image, float scale);
  static float bilinear(const Level& level, float x, float y);

  std::vector<Level> levels_;
};

}  // namespace camera_self_calibration
