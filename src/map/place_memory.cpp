#include "camera_self_calibration/map/place_memory.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/map/inverse_depth.h"

namespace camera_self_calibration {
namespace {

constexpr double kSameViewAngle = 10.0 * kDegree;
constexpr double kSameViewDistance = 0.1;  // [median depths]
constexpr std::size_t kMinSightings = 3;   // of a point whose depth can be relied on

bool sameView(const Place& a, const Place& b) {
  if (a.map_id != b.map_id) return false;
  const double distance =
      (a.world_from_camera.translation - b.world_from_camera.translation).norm();
  return a.world_from_camera.rotation.angularDistance(b.world_from_camera.rotation) <
             kSameViewAngle &&
         distance * a.inverse_depth < kSameViewDistance;
}

double typicalOf(const Place& place) {
  std::vector<WorldPoint> known;
  for (const PlacePoint& point : place.points) {
    if (point.known) known.push_back(point);
  }
  return typicalInverseDepthFrom(place.world_from_camera.translation, known);
}

void refreshPoint(const Map& map, const Camera& camera, PlacePoint* point) {
  const auto found = map.points().find(point->track_id);
  if (found == map.points().end() || found->second.sightings.size() < kMinSightings) return;
  const auto now = map.worldPoint(found->second, camera);
  if (now) *point = {*now, point->track_id, true};
}

}  // namespace

void PlaceMemory::add(std::uint64_t map_id, const Keyframe& keyframe,
                      const std::vector<Appearance>& appearances) {
  Place place;
  place.map_id = map_id;
  place.keyframe_id = keyframe.id;
  place.world_from_camera = keyframe.world_from_camera;
  for (const Appearance& appearance : appearances) {
    if (appearance.track_id == kNoTrack) continue;  // it gets no depth
    PlacePoint point;
    point.track_id = appearance.track_id;
    place.points.push_back(point);
    place.descriptors.push_back(appearance.descriptor);
  }
  auto replaced = std::find_if(places_.begin(), places_.end(),
                               [&](const Place& older) { return sameView(older, place); });
  if (replaced == places_.end() && places_.size() >= capacity_) replaced = places_.begin();
  if (replaced != places_.end()) places_.erase(replaced);
  places_.push_back(std::move(place));
}

void PlaceMemory::refresh(std::uint64_t map_id, const Map& map, const Camera& camera) {
  for (Place& place : places_) {
    if (place.map_id != map_id) continue;
    const Keyframe* keyframe = map.keyframe(place.keyframe_id);
    if (keyframe == nullptr) continue;
    place.world_from_camera = keyframe->world_from_camera;
    for (PlacePoint& point : place.points) refreshPoint(map, camera, &point);
    place.inverse_depth = typicalOf(place);
  }
}

void PlaceMemory::move(std::uint64_t from_map_id, std::uint64_t to_map_id,
                       const Similarity3& to_from_from) {
  for (Place& place : places_) {
    if (place.map_id != from_map_id) continue;
    place.map_id = to_map_id;
    place.world_from_camera = to_from_from * place.world_from_camera;
    place.inverse_depth /= to_from_from.scale;
    for (PlacePoint& point : place.points) {
      point.direction = to_from_from.motion.rotation * point.direction;
      point.origin = to_from_from * point.origin;
      point.inverse_depth /= to_from_from.scale;
    }
  }
}

void PlaceMemory::keepOnly(std::uint64_t map_id) {
  places_.erase(std::remove_if(places_.begin(), places_.end(),
                               [&](const Place& place) { return place.map_id != map_id; }),
                places_.end());
}

bool PlaceMemory::knowsMapBefore(std::uint64_t map_id) const {
  return std::any_of(places_.begin(), places_.end(),
                     [&](const Place& place) { return place.map_id < map_id; });
}

}  // namespace camera_self_calibration
