#pragma once

#include <cstdint>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/geometry/similarity.h"
#include "camera_self_calibration/map/map.h"
#include "camera_self_calibration/tracking/appearance.h"

namespace camera_self_calibration {

/// A point of the scene that a track showed, in the world of its map.
struct PlacePoint : WorldPoint {
  std::int64_t track_id = 0;
  bool known = false;  ///< Whether it has a depth; the rest is void otherwise.
};

/// A keyframe that outlives its map: where it was, and what its points look like. Nothing in it
/// depends on the intrinsics.
struct Place {
  std::uint64_t map_id = 0;
  std::int64_t keyframe_id = 0;
  Rigid3 world_from_camera;
  double inverse_depth = 1.0;           ///< Typical of its points: 1 / distance from it.
  std::vector<PlacePoint> points;       ///< In the order of descriptors.
  std::vector<Descriptor> descriptors;  ///< One a point.
};

/// Places of this map and of those before it, at most `capacity` whatever the length of the run.
class PlaceMemory {
 public:
  explicit PlaceMemory(int capacity) : capacity_(static_cast<std::size_t>(capacity)) {}

  /// Remembers a keyframe of the map. It takes the place of an older one of the same map with
  /// nearly the same view; else, if the memory is full, of the oldest.
  void add(std::uint64_t map_id, const Keyframe& keyframe,
           const std::vector<Appearance>& appearances);

  /// Takes over the poses and depths of the places whose keyframes are still in the map.
  void refresh(std::uint64_t map_id, const Map& map, const Camera& camera);

  /// Takes all places of one map over into another map, or into another scale of its own.
  void move(std::uint64_t from_map_id, std::uint64_t to_map_id, const Similarity3& to_from_from);

  /// Forgets the places of all other maps.
  void keepOnly(std::uint64_t map_id);

  /// Whether there is a place of a map with a smaller id.
  bool knowsMapBefore(std::uint64_t map_id) const;

  /// In the order in which they were added.
  const std::vector<Place>& places() const { return places_; }

 private:
  std::size_t capacity_;
  std::vector<Place> places_;
};

}  // namespace camera_self_calibration
