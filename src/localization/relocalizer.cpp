#include "camera_self_calibration/localization/relocalizer.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/median.h"

namespace camera_self_calibration {
namespace {

// Keyframes of a map before its depths are worth anything.
constexpr int kMinKeyframes = 4;
// Every so many keyframes one is remembered.
constexpr int kPlaceEvery = 2;
// A map that was searched for in vain is searched for less and less often.
constexpr int kPatience = 10;
constexpr int kMaxInterval = 10;
// Of the places, those that look most alike are looked at closely.
constexpr std::size_t kTried = 3;
// Corners beside the tracks, in which a place is sought: of those that were followed there, the
// tracks of today are a small choice.
constexpr int kCorners = 400;
constexpr std::size_t kScouts = 64;
constexpr std::size_t kMinScouts = 3;
constexpr std::size_t kMaxSightings = 6;
constexpr std::size_t kMinSightings = 3;
constexpr std::size_t kMinDepths = 10;
constexpr double kMaxScaleError = 0.02;
// How far two keyframes may disagree.
constexpr double kMaxAngle = 2.0 * kDegree;
constexpr double kMaxDistance = 0.05;  // [median depths]

// Logarithm of lengths in the old map over those in the new one, for each point that both know.
// `new_from_camera` is where the place was seen from.
void addLogScales(const RecognizedPlace& place, const Rigid3& new_from_camera, const Map& map,
                  const Camera& camera, std::vector<double>* values) {
  for (const SeenAgain& seen : place.seen) {
    const auto now = map.points().find(seen.track_id);
    if (now == map.points().end() || now->second.sightings.size() < kMinSightings) continue;
    const auto new_inverse = map.inverseDepthFrom(new_from_camera, now->second, camera);
    const double old_inverse = inverseDistance(seen.point, place.old_from_camera.translation);
    if (new_inverse && *new_inverse > 0.0 && old_inverse > 0.0) {
      values->push_back(std::log(*new_inverse / old_inverse));
    }
  }
}

// Their median, where its standard error is small.
std::optional<double> commonScale(const std::vector<double>& log_scales) {
  if (log_scales.size() < kMinDepths) return std::nullopt;
  const double middle = median(log_scales, 0.0);
  std::vector<double> deviations;
  for (const double value : log_scales) deviations.push_back(std::abs(value - middle));
  constexpr double kSigmaOfMad = 1.4826;
  constexpr double kErrorOfMedian = 1.2533;
  const double error = kErrorOfMedian * kSigmaOfMad * median(std::move(deviations), 0.0) /
                       std::sqrt(static_cast<double>(log_scales.size()));
  if (!(error < kMaxScaleError)) return std::nullopt;
  return std::exp(middle);
}

// Whether two similarities put the newest keyframe at the same place.
bool agree(const Similarity3& a, const Similarity3& b, const Map& map, const Camera& camera) {
  const Keyframe& newest = map.keyframes().back();
  const Rigid3 one = a * newest.world_from_camera;
  const Rigid3 other = b * newest.world_from_camera;
  const double depths = (one.translation - other.translation).norm() / b.scale *
                        map.typicalInverseDepthAt(newest.id, camera);
  return depths < kMaxDistance && one.rotation.angularDistance(other.rotation) < kMaxAngle;
}

}  // namespace

void Relocalizer::clear() { *this = Relocalizer(capacity_); }

std::optional<Relocation> Relocalizer::atKeyframe(std::uint64_t map_id, const Map& map,
                                                  const Camera& camera,
                                                  const std::vector<Track>& tracks, bool trusted,
                                                  const Describe& describe) {
  if (capacity_ <= 0 || !describe) return std::nullopt;
  if (map_id != map_id_) {
    map_id_ = map_id;
    keyframes_ = next_look_ = 0;
    sightings_.clear();
  }
  const bool looks = keyframes_ >= next_look_ && memory_.knowsMapBefore(map_id);
  const bool remembers = trusted && keyframes_ >= kMinKeyframes && keyframes_ % kPlaceEvery == 0;
  ++keyframes_;
  std::vector<Appearance> appearances;
  if (looks || remembers) appearances = describe(tracks, looks ? kCorners : 0);
  if (remembers) memory_.add(map_id, map.keyframes().back(), appearances);
  memory_.refresh(map_id, map, camera);
  if (looks) look(map, camera, appearances);
  const std::optional<Relocation> relocation = conclude(map, camera);
  if (!relocation) return std::nullopt;
  memory_.move(map_id_, relocation->map_id, relocation->old_from_new);
  map_id_ = relocation->map_id;
  sightings_.clear();
  return relocation;
}

void Relocalizer::look(const Map& map, const Camera& camera,
                       const std::vector<Appearance>& appearances) {
  next_look_ = keyframes_ + std::min(keyframes_ / kPatience, kMaxInterval);
  auto place = recognizeAny(camera, appearances);
  if (!place) place = recognizeExpected(map, camera, appearances);
  if (!place) return;
  next_look_ = keyframes_;
  if (sightings_.size() >= kMaxSightings) sightings_.erase(sightings_.begin());
  sightings_.push_back({map.keyframes().back().id, std::move(*place)});
}

// A few features tell which places are worth a comparison with all.
std::vector<const Place*> Relocalizer::likelyPlaces(
    const std::vector<Appearance>& appearances) const {
  std::vector<Appearance> scouts;
  const std::size_t step = appearances.size() / kScouts + 1;
  for (std::size_t i = 0; i < appearances.size(); i += step) {
    scouts.push_back(appearances[i]);
  }
  std::vector<std::pair<std::size_t, const Place*>> ranked;
  for (const Place& place : memory_.places()) {
    if (place.map_id >= map_id_) continue;
    const std::size_t matches = matchPlace(place, scouts).size();
    if (matches >= kMinScouts) ranked.emplace_back(matches, &place);
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  ranked.resize(std::min(ranked.size(), kTried));
  std::vector<const Place*> places;
  for (const auto& [matches, place] : ranked) places.push_back(place);
  return places;
}

std::optional<RecognizedPlace> Relocalizer::recognizeAny(
    const Camera& camera, const std::vector<Appearance>& appearances) const {
  for (const Place* place : likelyPlaces(appearances)) {
    const auto pose = poseAtPlace(*place, matchPlace(*place, appearances), camera);
    if (!pose) continue;
    auto recognized = confirmPose(memory_.places(), place->map_id, *pose, appearances, camera);
    if (recognized) return recognized;
  }
  return std::nullopt;
}

// From where an earlier keyframe was recognised.
std::optional<RecognizedPlace> Relocalizer::recognizeExpected(
    const Map& map, const Camera& camera, const std::vector<Appearance>& appearances) const {
  for (auto sighting = sightings_.rbegin(); sighting != sightings_.rend(); ++sighting) {
    const Keyframe* then = map.keyframe(sighting->keyframe_id);
    if (then == nullptr) continue;
    std::vector<double> log_scales;
    addLogScales(sighting->place, then->world_from_camera, map, camera, &log_scales);
    const auto scale = commonScale(log_scales);
    if (!scale) continue;
    const Similarity3 old_from_new =
        similarityBetween(sighting->place.old_from_camera, then->world_from_camera, *scale);
    const Rigid3 expected = old_from_new * map.keyframes().back().world_from_camera;
    auto recognized =
        confirmPose(memory_.places(), sighting->place.map_id, expected, appearances, camera);
    if (recognized) return recognized;
  }
  return std::nullopt;
}

std::optional<Relocation> Relocalizer::conclude(const Map& map, const Camera& camera) const {
  for (std::size_t later = 1; later < sightings_.size(); ++later) {
    for (std::size_t earlier = 0; earlier < later; ++earlier) {
      const auto relocation = conclude(sightings_[earlier], sightings_[later], map, camera);
      if (relocation) return relocation;
    }
  }
  return std::nullopt;
}

std::optional<Relocation> Relocalizer::conclude(const Sighting& a, const Sighting& b,
                                                const Map& map, const Camera& camera) {
  const Keyframe* at_a = map.keyframe(a.keyframe_id);
  const Keyframe* at_b = map.keyframe(b.keyframe_id);
  if (at_a == nullptr || at_b == nullptr || a.place.map_id != b.place.map_id) return std::nullopt;
  std::vector<double> log_scales;
  addLogScales(a.place, at_a->world_from_camera, map, camera, &log_scales);
  addLogScales(b.place, at_b->world_from_camera, map, camera, &log_scales);
  const auto scale = commonScale(log_scales);
  if (!scale) return std::nullopt;
  const Similarity3 from_a =
      similarityBetween(a.place.old_from_camera, at_a->world_from_camera, *scale);
  const Similarity3 from_b =
      similarityBetween(b.place.old_from_camera, at_b->world_from_camera, *scale);
  if (!agree(from_a, from_b, map, camera)) return std::nullopt;
  const bool more_in_a = a.place.seen.size() > b.place.seen.size();
  return Relocation{a.place.map_id, more_in_a ? from_a : from_b,
                    static_cast<int>(std::max(a.place.seen.size(), b.place.seen.size()))};
}

}  // namespace camera_self_calibration
