#pragma once

#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

struct TrackerOptions {
  /// Good tracks, at most. Those that have become poor, or are not found for some images, are
  /// followed beside them, as many again at most.
  int max_features = 128;
  double min_distance_px = 0.0;  ///< Between features; 0: chosen from image size and count.
  /// 0 where no feature may be, as on parts of the robot; scaled to the images. None: everywhere.
  std::optional<ImageView> mask;

  /// Every violated bound in one sentence each; empty if all is well.
  std::vector<std::string> problems() const;
};

struct KeyframeOptions {
  double min_parallax = 0.01;      ///< Median track motion beyond rotation, per longer side.
  double min_rotation_deg = 5.0;   ///< [deg]
  double min_tracked_share = 0.7;  ///< Of the last keyframe's tracks; fewer make a keyframe.

  std::vector<std::string> problems() const;
};

}  // namespace camera_self_calibration
