#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "camera_self_calibration/tracking/pyramid.h"

namespace camera_self_calibration {

/// Where one point of an image is in another, by its surroundings (Lucas and Kanade): on the
/// coarsest level first, each finer one from there. Gradients are those of the window itself, so
/// that nothing is computed of the image as a whole.
class LucasKanade {
 public:
  /// Columns and rows of what is cut out of `from`: they fill the processor's vectors. The window
  /// itself is a pixel less on each side, for the sake of the gradients.
  static constexpr int kSide = 16;
  static constexpr int kRows = kSide - 2;

  struct Effort {
    int coarsest_level = 0;
    int iterations = 10;  ///< At most, on each level.
    float step = 0.05f;   ///< Shorter ones end the search on a level [px].
  };

  /// `position` holds a first guess; on return the place in `to`. `gain` is the brightness of `to`
  /// against that of `from`. False if the finest level has too little texture there, or the window
  /// leaves the image.
  bool follow(const ImagePyramid& from, float gain, const cv::Point2f& point,
              const ImagePyramid& to, const Effort& effort, cv::Point2f* position);

 private:
  bool setWindow(const cv::Mat& image, float gain, const cv::Point2f& point);
  bool seek(const cv::Mat& image, const Effort& effort, cv::Point2f* position) const;

  // Of `from`, with a margin for the neighbours of the first and last.
  alignas(32) std::array<float, kSide * kSide + 2 * kSide> patch_{};
  alignas(32) std::array<float, kSide * kRows> gradient_x_{};  // [gray/px]
  alignas(32) std::array<float, kSide * kRows> gradient_y_{};
  float xx_ = 0.0f, xy_ = 0.0f, yy_ = 0.0f;  // sums of the gradients' products
};

}  // namespace camera_self_calibration
