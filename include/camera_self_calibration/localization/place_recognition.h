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

/// Features of the present image that look like points of a map where a pose in it says that these
/// are seen: points of all its places, each once.
std::vector<SeenAgain> matchNear(const std::vector<Place>& places, std::uint64_t map_id,
                                 const Rigid3& old_from_camera,
                                 const std::vector<Appearance>& appearances, const Camera& camera);

/// Where the camera might be if the present image showed the place: the pose that most of the
/// matches agree with (eq. 1), found from many small samples of them. Nothing where too few do.
/// Equal input gives equal results.
std::optional<Rigid3> poseAtPlace(const Place& place, const std::vector<SeenAgain>& matches,
                                  const Camera& camera);

/// Whether the present image is seen from about that pose: enough of what matches near it
/// (matchNear) must agree with one pose. Nothing where too little does, or where it does not
/// determine the pose.
std::optional<RecognizedPlace> confirmPose(const std::vector<Place>& places, std::uint64_t map_id,
                                           const Rigid3& old_from_camera,
                                           const std::vector<Appearance>& appearances,
                                           const Camera& camera);

}  // namespace camera_self_calibration
