#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/map/place_memory.h"
#include "camera_self_calibration/tracking/appearance.h"

namespace camera_self_calibration {

/// A feature of the present image that is a point of a place.
struct SeenAgain {
  std::int64_t track_id = 0;  ///< Of the present image.
  PlacePoint point;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< In the present image.
};

/// The present camera in the map of a place.
struct RecognizedPlace {
  std::uint64_t map_id = 0;
  Rigid3 old_from_camera;
  std::vector<SeenAgain> seen;  ///< The features that agree with that pose.
};

/// Features of the present image that look like points of the place whose depths are known.
std::vector<SeenAgain> matchPlace(const Place& place, const std::vector<Appearance>& appearances);

/// Whether the present image shows the place: the matches must agree with one pose (eq. 1), found
/// from many small samples of them. Nothing where too few do, or where they do not determine the
/// pose. Equal input gives equal results.
std::optional<RecognizedPlace> recognize(const Place& place, const std::vector<SeenAgain>& matches,
                                         const Camera& camera);

}  // namespace camera_self_calibration
