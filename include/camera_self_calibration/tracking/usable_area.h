#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

/// Where the user allows features: parts of the robot in the image move with the camera, and would
/// look like a scene that stands still.
class UsableArea {
 public:
  /// `mask`: 0 where no feature may be; without one every place is allowed.
  explicit UsableArea(const std::optional<ImageView>& mask);

  /// The mask is scaled to images of this size [px].
  void setImageSize(int width, int height);

  /// Whether nothing within `margin` [px of the image, along its axes] is masked.
  bool contains(double x, double y, int margin) const;

 private:
  cv::Mat mask_;      // As given; empty: none.
  cv::Mat distance_;  // Of the image's size: how far it is to what is masked.
};

}  // namespace camera_self_calibration
