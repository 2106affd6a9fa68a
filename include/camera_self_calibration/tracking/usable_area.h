#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

/// Where the user allows features: parts of the robot in the image move with the camera, and would
/// look like a scene that stands still.
class UsableArea {
 public:
  /// `mask`: 0 where no feature may be; without one every place is allowed. Features keep `margin`
  /// [px of the image] away from what is masked.
  UsableArea(const std::optional<ImageView>& mask, int margin);

  /// The mask is scaled to images of this size [px].
  void setImageSize(int width, int height);

  bool contains(double x, double y) const;

 private:
  cv::Mat mask_;    // As given; empty: none.
  cv::Mat usable_;  // Of the image's size, without the margin.
  int margin_;
};

}  // namespace camera_self_calibration
