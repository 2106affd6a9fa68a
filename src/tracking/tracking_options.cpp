#include "camera_self_calibration/tracking/tracking_options.h"

#include <cmath>

namespace camera_self_calibration {

std::vector<std::string> TrackerOptions::problems() const {
  std::vector<std::string> found;
  if (max_features < 1 || max_features > 10000) {
    found.push_back("max_features must lie between 1 and 10000; it is " +
                    std::to_string(max_features) + ".");
  }
  if (!(min_distance_px >= 0.0 && std::isfinite(min_distance_px))) {
    found.push_back(
        "min_distance_px must be 0 (chosen automatically) or a positive number of "
        "pixels.");
  }
  return found;
}

std::vector<std::string> KeyframeOptions::problems() const {
  std::vector<std::string> found;
  if (!(min_parallax > 0.0 && min_parallax < 1.0)) {
    found.push_back("min_parallax must lie between 0 and 1 times the image's longer side; it is " +
                    std::to_string(min_parallax) + ".");
  }
  if (!(min_rotation_deg > 0.0 && min_rotation_deg < 180.0)) {
    found.push_back("min_rotation_deg must lie between 0 and 180 degrees; it is " +
                    std::to_string(min_rotation_deg) + ".");
  }
  if (!(min_tracked_share >= 0.0 && min_tracked_share <= 1.0)) {
    found.push_back("min_tracked_share must lie between 0 and 1; it is " +
                    std::to_string(min_tracked_share) + ".");
  }
  return found;
}

}  // namespace camera_self_calibration
