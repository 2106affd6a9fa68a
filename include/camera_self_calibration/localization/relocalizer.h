#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/geometry/similarity.h"
#include "camera_self_calibration/localization/place_recognition.h"
#include "camera_self_calibration/map/map.h"
#include "camera_self_calibration/map/place_memory.h"
#include "camera_self_calibration/tracking/appearance.h"

namespace camera_self_calibration {

/// Where the present map lies in an older one.
struct Relocation {
  std::uint64_t map_id = 0;  ///< Of the older map.
  Similarity3 old_from_new;
  int seen = 0;  ///< Features that agree.
};

/// Remembers places, and finds the way back into a map that was lost: keyframes of a new map are
/// compared with the places of older ones. What is seen again gives the pose in the old map; the
/// scale comes from the depths that both maps know, once the new one knows them. From then on it is
/// known where later keyframes have to see the points of the old map, which finds far more of them
/// than looks alone. Two keyframes must agree on pose and scale before it is believed.
class Relocalizer {
 public:
  /// At most `max_places` keyframes are remembered; 0: none, nothing is ever recognised.
  explicit Relocalizer(int max_places) : capacity_(max_places), memory_(max_places) {}

  /// At each keyframe, the newest of `map`. `trusted`: its poses and depths are worth remembering.
  /// Where the result is a relocation all places of the present map are in the old one from now on,
  /// and the caller has to move the map too.
  std::optional<Relocation> atKeyframe(std::uint64_t map_id, const Map& map, const Camera& camera,
                                       const std::vector<Track>& tracks, bool trusted,
                                       const Describe& describe);

  /// The map has another scale, and a new id. All others are forgotten.
  void scaleMap(std::uint64_t from_map_id, std::uint64_t to_map_id, double factor) {
    memory_.move(from_map_id, to_map_id, {Rigid3(), factor});
    memory_.keepOnly(to_map_id);
  }

  /// Forgets all places.
  void clear();

  const PlaceMemory& memory() const { return memory_; }

 private:
  struct Sighting {
    std::int64_t keyframe_id = 0;  // of the present map
    RecognizedPlace place;
  };

  void look(const Map& map, const Camera& camera, const std::vector<Appearance>& appearances);
  std::vector<const Place*> likelyPlaces(const std::vector<Appearance>& appearances) const;
  std::optional<RecognizedPlace> recognizeAny(const Camera& camera,
                                              const std::vector<Appearance>& appearances) const;
  std::optional<RecognizedPlace> recognizeExpected(
      const Map& map, const Camera& camera, const std::vector<Appearance>& appearances) const;
  std::optional<Relocation> conclude(const Map& map, const Camera& camera) const;
  static std::optional<Relocation> conclude(const Sighting& a, const Sighting& b, const Map& map,
                                            const Camera& camera);

  int capacity_;
  PlaceMemory memory_;
  std::uint64_t map_id_ = 0;         // the one looked at last
  int keyframes_ = 0;                // of it
  int next_look_ = 0;                // at this many keyframes
  std::vector<Sighting> sightings_;  // of older maps, not concluded from yet
};

}  // namespace camera_self_calibration
