#include "camera_self_calibration/map/map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "camera_self_calibration/map/rolling_shutter.h"

namespace camera_self_calibration {

const Map::Sighting* sightingIn(const Map::Point& point, std::int64_t keyframe_id) {
  for (const Map::Sighting& sighting : point.sightings) {
    if (sighting.keyframe_id == keyframe_id) return &sighting;
  }
  return nullptr;
}

void Map::addKeyframe(const Keyframe& keyframe, const std::vector<Track>& tracks,
                      double new_inverse_depth, const Camera& camera) {
  keyframes_.push_back(keyframe);
  keyframes_.back().line_delay_s = line_delay_s_;
  for (const Track& track : tracks) {
    const auto [entry, is_new] = points_.try_emplace(track.id);
    Point& point = entry->second;
    if (is_new) {
      const bool detected_here = track.pixel == track.reference_pixel;
      point.reference_id = detected_here ? keyframe.id : -1;
      point.reference_pixel = track.reference_pixel;
      point.anchor_id = keyframe.id;
      point.inverse_depth = new_inverse_depth;
    }
    point.sightings.push_back({keyframe.id, track.pixel, track.sigma});
    Sighting& sighting = point.sightings.back();
    sighting.shift.motion = track.motion;
    placePixel(line_delay_s_, camera.height(), &sighting.pixel, &sighting.shift);
  }
  while (static_cast<int>(keyframes_.size()) > max_keyframes_) removeOldest(camera);
}

void Map::removeOldest(const Camera& camera) {
  const Keyframe oldest = keyframes_.front();
  keyframes_.pop_front();
  for (auto entry = points_.begin(); entry != points_.end();) {
    Point& point = entry->second;
    auto& sightings = point.sightings;
    if (!sightings.empty() && sightings.front().keyframe_id == oldest.id) {
      const Eigen::Vector2d anchor_pixel = sightings.front().pixel;
      sightings.erase(sightings.begin());
      if (point.anchor_id == oldest.id && !sightings.empty()) {
        const Keyframe& next = *keyframe(sightings.front().keyframe_id);
        point.anchor_id = next.id;
        if (const auto ray = cameraOf(oldest, camera).unproject(anchor_pixel)) {
          point.inverse_depth = transferInverseDepth(oldest.world_from_camera, *ray,
                                                     point.inverse_depth, next.world_from_camera);
        }
      }
    }
    entry = sightings.empty() ? points_.erase(entry) : std::next(entry);
  }
}

void Map::changeLens(std::int64_t onset_ns, const Camera& earlier, const Camera& present) {
  while (!keyframes_.empty() && keyframes_.front().lens != kPresentLens) removeOldest(present);
  held_lenses_ = {earlier};
  for (Keyframe& keyframe : keyframes_) {
    if (keyframe.stamp_ns < onset_ns) keyframe.lens = 0;
  }
}

void Map::setLineDelay(double line_delay_s, int image_height) {
  line_delay_s_ = line_delay_s;
  for (Keyframe& keyframe : keyframes_) keyframe.line_delay_s = line_delay_s;
  for (auto& [track_id, point] : points_) {
    for (Sighting& sighting : point.sightings) {
      placePixel(line_delay_s, image_height, &sighting.pixel, &sighting.shift);
    }
  }
}

void Map::setMotions(std::int64_t keyframe_id, const std::map<std::int64_t, ImageMotion>& motions,
                     int image_height) {
  for (const auto& [track_id, motion] : motions) {
    const auto found = points_.find(track_id);
    if (found == points_.end()) continue;
    for (Sighting& sighting : found->second.sightings) {
      if (sighting.keyframe_id != keyframe_id) continue;
      sighting.shift.motion = motion;
      placePixel(line_delay_s_, image_height, &sighting.pixel, &sighting.shift);
    }
  }
}

int Map::keyframesSince(std::int64_t stamp_ns) const {
  return static_cast<int>(std::count_if(keyframes_.begin(), keyframes_.end(),
                                        [&](const Keyframe& k) { return k.stamp_ns >= stamp_ns; }));
}

void Map::removePoints(const std::vector<std::int64_t>& track_ids) {
  for (const std::int64_t id : track_ids) points_.erase(id);
}

void Map::clear() {
  held_lenses_.clear();
  keyframes_.clear();
  points_.clear();
}

void Map::move(const Similarity3& other_from_world) {
  for (Keyframe& keyframe : keyframes_) {
    keyframe.world_from_camera = other_from_world * keyframe.world_from_camera;
    keyframe.velocity.head<3>() *= other_from_world.scale;
  }
  for (auto& [track_id, point] : points_) point.inverse_depth /= other_from_world.scale;
}

const Keyframe* Map::keyframe(std::int64_t id) const {
  const auto found = std::lower_bound(
      keyframes_.begin(), keyframes_.end(), id,
      [](const Keyframe& keyframe, std::int64_t key) { return keyframe.id < key; });
  return found != keyframes_.end() && found->id == id ? &*found : nullptr;
}

Segment Map::segmentFrom(int first, const Camera& camera) const {
  return segmentOf(first, static_cast<int>(keyframes_.size()), camera);
}

Segment Map::lastKeyframes(int count, const Camera& camera, int newer) const {
  const int end = static_cast<int>(keyframes_.size()) - newer;
  return segmentOf(std::max(0, end - count), end, camera);
}

Segment Map::segmentOf(int first, int end, const Camera& camera) const {
  Segment segment;
  if (first >= end) return segment;
  segment.keyframes.assign(keyframes_.begin() + first, keyframes_.begin() + end);
  segment.sequence = segment.keyframes.back().id;
  std::map<std::int64_t, int> index;  // keyframe id to index in the segment
  for (std::size_t k = 0; k < segment.keyframes.size(); ++k) {
    index[segment.keyframes[k].id] = static_cast<int>(k);
  }
  if (segment.isLensHeld(0)) segment.held_lenses = held_lenses_;
  for (const auto& [track_id, point] : points_) {
    const auto begin = std::find_if(
        point.sightings.begin(), point.sightings.end(),
        [&](const Sighting& s) { return s.keyframe_id >= segment.keyframes.front().id; });
    const auto last = std::find_if(begin, point.sightings.end(), [&](const Sighting& s) {
      return s.keyframe_id > segment.keyframes.back().id;
    });
    if (last - begin < 2) continue;
    if (const auto landmark = landmarkFrom(track_id, point, *begin, camera)) {
      const int landmark_index = static_cast<int>(segment.landmarks.size());
      segment.landmarks.push_back(*landmark);
      segment.landmarks.back().reference = index[begin->keyframe_id];
      for (auto s = begin + (landmark->anchored ? 1 : 0); s != last; ++s) {
        segment.observations.push_back(
            {landmark_index, index[s->keyframe_id], s->pixel, s->sigma, s->shift});
      }
    }
  }
  return segment;
}

std::optional<Landmark> Map::landmarkFrom(std::int64_t track_id, const Point& point,
                                          const Sighting& first, const Camera& camera) const {
  const auto first_ray = cameraOf(*keyframe(first.keyframe_id), camera).unproject(first.pixel);
  const auto inverse_depth =
      inverseDepthFrom(keyframe(first.keyframe_id)->world_from_camera, point, camera);
  if (!first_ray || !inverse_depth) return std::nullopt;
  Landmark landmark;
  landmark.track_id = track_id;
  landmark.anchored = exact_references_ && first.keyframe_id == point.reference_id;
  landmark.reference_pixel = landmark.anchored ? first.pixel : point.reference_pixel;
  if (landmark.anchored) landmark.reference_shift = first.shift;
  landmark.bearing = *first_ray;
  landmark.inverse_depth = *inverse_depth;
  return landmark;
}

void Map::update(const Segment& segment) {
  for (const Keyframe& solved : segment.keyframes) {
    for (Keyframe& keyframe : keyframes_) {
      if (keyframe.id != solved.id) continue;
      const int lens = keyframe.lens;
      keyframe = solved;
      keyframe.lens = lens;
      keyframe.line_delay_s = line_delay_s_;
    }
  }
  std::map<std::int64_t, const Rigid3*> solved_poses;  // by keyframe id
  for (const Keyframe& solved : segment.keyframes) {
    solved_poses[solved.id] = &solved.world_from_camera;
  }
  for (const Landmark& landmark : segment.landmarks) {
    const auto found = points_.find(landmark.track_id);
    if (found == points_.end()) continue;
    Point& point = found->second;
    // The map may have moved on meanwhile: the reference keyframe may be gone, or the point be a
    // new one of the same track. The depth goes to the oldest sighting left that the solution
    // knows.
    const auto anchor =
        std::find_if(point.sightings.begin(), point.sightings.end(),
                     [&](const Sighting& s) { return solved_poses.count(s.keyframe_id) > 0; });
    if (anchor == point.sightings.end()) continue;
    const Keyframe& reference = segment.keyframes[landmark.reference];
    point.anchor_id = anchor->keyframe_id;
    point.inverse_depth =
        anchor->keyframe_id == reference.id
            ? landmark.inverse_depth
            : transferInverseDepth(reference.world_from_camera, landmark.bearing,
                                   landmark.inverse_depth, *solved_poses[anchor->keyframe_id]);
  }
}

std::optional<WorldPoint> Map::worldPoint(const Point& point, const Camera& camera) const {
  const Keyframe* anchor = keyframe(point.anchor_id);
  const Sighting* sighting = sightingIn(point, point.anchor_id);
  if (anchor == nullptr || sighting == nullptr) return std::nullopt;
  const auto ray = cameraOf(*anchor, camera).unproject(sighting->pixel);
  if (!ray) return std::nullopt;
  return WorldPoint{anchor->world_from_camera.rotation * *ray,
                    anchor->world_from_camera.translation, point.inverse_depth};
}

std::optional<double> Map::inverseDepthFrom(const Rigid3& world_from_camera, const Point& point,
                                            const Camera& camera) const {
  const auto known = worldPoint(point, camera);
  if (!known) return std::nullopt;
  return inverseDistance(*known, world_from_camera.translation);
}

std::vector<WorldPoint> Map::worldPoints(const std::vector<std::int64_t>& track_ids,
                                         const Camera& camera) const {
  std::vector<WorldPoint> known;
  for (const std::int64_t track_id : track_ids) {
    const auto found = points_.find(track_id);
    if (found == points_.end()) continue;
    if (const auto point = worldPoint(found->second, camera)) known.push_back(*point);
  }
  return known;
}

double Map::typicalInverseDepthAt(std::int64_t keyframe_id, const Camera& camera) const {
  const Keyframe* observer = keyframe(keyframe_id);
  if (observer == nullptr) return 1.0;
  std::vector<WorldPoint> seen;
  for (const auto& [track_id, point] : points_) {
    if (sightingIn(point, keyframe_id) == nullptr) continue;
    if (const auto known = worldPoint(point, camera)) seen.push_back(*known);
  }
  return typicalInverseDepthFrom(observer->world_from_camera.translation, seen);
}

}  // namespace camera_self_calibration
