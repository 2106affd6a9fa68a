#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "camera_self_calibration/tracking/pyramid.h"

namespace camera_self_calibration {

struct Corner {
  int x = 0;  ///< [px]
  int y = 0;  ///< [px]
  float response = 0.0f;
};

/// Harris corners, the local maxima of det S - 0.04 (trace S)^2 with S the structure tensor, found
/// over a whole image and put in an order that spreads them.
class HarrisDetector {
 public:
  /// Local maxima at least `border` pixels inside, none weaker than a small share of the strong
  /// ones; first the best of every cell of a grid of `cell` pixels, then every cell's second, ...,
  /// the strongest first in each round. Valid until the next call.
  const std::vector<Corner>& detect(const ImagePyramid& image, int border, int cell);

 private:
  void smoothedRow(const cv::Mat& image, int y);
  void respond(const cv::Mat& image);
  void findMaxima(int border);
  void order(int cell);

  static constexpr int kTaps = 5;
  cv::Mat response_;
  std::vector<float> products_;                     // One row: xx, xy, yy.
  std::array<std::vector<float>, kTaps> smoothed_;  // Rows of products, smoothed along x.
  std::vector<Corner> corners_;
  std::vector<std::size_t> round_;  // Per corner, its rank in its cell.
  std::vector<std::size_t> in_cell_;
  std::vector<std::size_t> begin_;  // Of each round.
  std::vector<Corner> ordered_;
};

}  // namespace camera_self_calibration
