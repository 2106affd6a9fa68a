#include "camera_self_calibration/map/segment_edit.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "camera_self_calibration/map/inverse_depth.h"

namespace camera_self_calibration {
namespace {

// All that is known of one track.
struct TrackRecord {
  std::map<int, Observation> sightings;  // by keyframe index in the result
  int anchor = -1;                       // keyframe with the exact reference pixel, or -1
  Landmark landmark;                     // with its reference in `solved`
  const Segment* solved = nullptr;       // where the landmark was solved; null: not yet
};

// Puts a segment together from parts that share keyframes and tracks.
class Assembly {
 public:
  Assembly(std::vector<Keyframe> keyframes, const std::vector<Camera>& held_lenses) {
    result_.keyframes = std::move(keyframes);
    result_.held_lenses = held_lenses;
  }

  // `index` tells for each keyframe of the part its index in the result, -1 if it is left out.
  void add(const Segment& part, const std::vector<int>& index, bool solved);
  // `camera` (may be null) gives the rays of landmarks that are not solved.
  Segment build(const Camera* camera);

 private:
  void place(const TrackRecord& record, int reference, const Camera* camera, Landmark* landmark);
  double typicalInverseDepthAt(int k) const;

  Segment result_;
  std::map<std::int64_t, TrackRecord> tracks_;
};

void Assembly::add(const Segment& part, const std::vector<int>& index, bool solved) {
  for (const Landmark& landmark : part.landmarks) {
    TrackRecord& record = tracks_[landmark.track_id];
    const int reference = index[landmark.reference];
    if (landmark.anchored && reference >= 0) record.anchor = reference;
    if (record.solved != nullptr) continue;
    record.landmark = landmark;
    if (solved) record.solved = &part;
  }
  for (const Observation& observation : part.observations) {
    const int k = index[observation.keyframe];
    if (k < 0) continue;
    // The newer part knows better how the feature moved.
    tracks_[part.landmarks[observation.landmark].track_id].sightings[k] = observation;
  }
}

// Of the solved landmarks that keyframe `k` sees, in its own frame.
double Assembly::typicalInverseDepthAt(int k) const {
  std::vector<WorldPoint> points;
  for (const auto& [track_id, record] : tracks_) {
    if (record.solved == nullptr || record.sightings.count(k) == 0) continue;
    points.push_back(worldPoint(record.landmark, *record.solved));
  }
  return typicalInverseDepthFrom(result_.keyframes[k].world_from_camera.translation, points);
}

void Assembly::place(const TrackRecord& record, int reference, const Camera* camera,
                     Landmark* landmark) {
  *landmark = record.landmark;
  landmark->reference = reference;
  landmark->anchored = record.anchor == reference;
  if (record.solved == nullptr) {
    const Eigen::Vector2d pixel =
        landmark->anchored ? landmark->reference_pixel : record.sightings.begin()->second.pixel;
    const Camera& seen_with = result_.cameraOf(reference, *camera);
    if (const auto ray = seen_with.unproject(pixel)) landmark->bearing = *ray;
    return;
  }
  const Keyframe& from = record.solved->keyframes[record.landmark.reference];
  if (from.id == result_.keyframes[reference].id) return;
  const Rigid3& there = from.world_from_camera;
  const Rigid3& here = result_.keyframes[reference].world_from_camera;
  const double rho = record.landmark.inverse_depth;
  // Eq. (1)
  landmark->bearing = (here.rotation.conjugate() * (there.rotation * record.landmark.bearing +
                                                    rho * (there.translation - here.translation)))
                          .normalized();
  landmark->inverse_depth = transferInverseDepth(there, record.landmark.bearing, rho, here);
}

Segment Assembly::build(const Camera* camera) {
  std::map<int, double> inverse_depth_at;  // where unsolved landmarks start, by keyframe
  for (auto& [track_id, record] : tracks_) {
    if (record.sightings.empty()) continue;
    const int first = record.sightings.begin()->first;
    const bool anchored = record.anchor >= 0 && record.anchor < first;
    if (!anchored && record.sightings.size() < 2) continue;
    const int index = static_cast<int>(result_.landmarks.size());
    Landmark landmark;
    place(record, anchored ? record.anchor : first, camera, &landmark);
    if (record.solved == nullptr) {
      const auto [entry, is_new] = inverse_depth_at.try_emplace(landmark.reference, 0.0);
      if (is_new) entry->second = typicalInverseDepthAt(landmark.reference);
      landmark.inverse_depth = entry->second;
    }
    result_.landmarks.push_back(landmark);
    for (const auto& [k, sighting] : record.sightings) {
      result_.observations.push_back(sighting);
      result_.observations.back().landmark = index;
      result_.observations.back().keyframe = k;
    }
  }
  result_.sequence = result_.keyframes.empty() ? 0 : result_.keyframes.back().id;
  return std::move(result_);
}

// [i * keyframes + j], i < j: landmarks that both see.
std::vector<int> sharedLandmarks(const Segment& segment) {
  const std::size_t keyframes = segment.keyframes.size();
  std::vector<std::vector<int>> seen_by(segment.landmarks.size());
  for (std::size_t l = 0; l < seen_by.size(); ++l) {
    // The reference keyframe of an anchored one sees it, and has no observation.
    if (segment.landmarks[l].anchored) seen_by[l].push_back(segment.landmarks[l].reference);
  }
  for (const Observation& observation : segment.observations) {
    seen_by[observation.landmark].push_back(observation.keyframe);
  }
  std::vector<int> shared(keyframes * keyframes, 0);
  for (const std::vector<int>& seeing : seen_by) {
    for (const int i : seeing) {
      for (const int j : seeing) {
        if (i < j) ++shared[static_cast<std::size_t>(i) * keyframes + static_cast<std::size_t>(j)];
      }
    }
  }
  return shared;
}

}  // namespace

void setEarlierLens(const Camera& earlier, int keyframes, Segment* segment) {
  segment->held_lenses = {earlier};
  for (int k = 0; k < static_cast<int>(segment->keyframes.size()); ++k) {
    segment->keyframes[k].lens = k < keyframes ? 0 : kPresentLens;
  }
}

void setOneLens(Segment* segment) {
  segment->held_lenses.clear();
  for (Keyframe& keyframe : segment->keyframes) keyframe.lens = kPresentLens;
}

int earlierKeyframes(const Segment& segment) {
  return static_cast<int>(
      std::count_if(segment.keyframes.begin(), segment.keyframes.end(),
                    [](const Keyframe& keyframe) { return keyframe.lens != kPresentLens; }));
}

Segment prefixOf(const Segment& segment, int keyframes, int min_views,
                 std::vector<int>* landmark_index) {
  Segment prefix;
  prefix.sequence = segment.sequence;
  prefix.held_lenses = segment.held_lenses;
  prefix.keyframes.assign(segment.keyframes.begin(), segment.keyframes.begin() + keyframes);
  std::vector<int> views(segment.landmarks.size(), 0);
  for (const Observation& observation : segment.observations) {
    views[observation.landmark] += observation.keyframe < keyframes;
  }
  std::vector<int> new_index(segment.landmarks.size(), -1);
  landmark_index->clear();
  for (std::size_t l = 0; l < segment.landmarks.size(); ++l) {
    const int needed = min_views + (segment.landmarks[l].anchored ? 0 : 1);
    if (segment.landmarks[l].reference >= keyframes || views[l] < needed) continue;
    new_index[l] = static_cast<int>(prefix.landmarks.size());
    prefix.landmarks.push_back(segment.landmarks[l]);
    landmark_index->push_back(static_cast<int>(l));
  }
  for (Observation observation : segment.observations) {
    if (observation.keyframe >= keyframes || new_index[observation.landmark] < 0) continue;
    observation.landmark = new_index[observation.landmark];
    prefix.observations.push_back(observation);
  }
  return prefix;
}

void adoptPrefix(const Segment& prefix, const std::vector<int>& landmark_index, Segment* segment) {
  std::copy(prefix.keyframes.begin(), prefix.keyframes.end(), segment->keyframes.begin());
  for (std::size_t l = 0; l < landmark_index.size(); ++l) {
    segment->landmarks[landmark_index[l]] = prefix.landmarks[l];
  }
}

Segment extended(const Segment& batch, const Segment& history, const Camera& camera) {
  if (batch.keyframes.empty()) return history;
  std::vector<Keyframe> keyframes = batch.keyframes;
  for (const Keyframe& keyframe : history.keyframes) {
    if (keyframe.id <= batch.keyframes.back().id) continue;
    keyframes.push_back(keyframe);
    keyframes.back().lens = kPresentLens;
  }
  // History dates a change of the lens only where it reaches back beyond it.
  const auto present = static_cast<std::size_t>(earlierKeyframes(history));
  const bool dated = present > 0 && present < history.keyframes.size();
  if (dated) {
    const std::int64_t change = history.keyframes[present].id;
    for (Keyframe& keyframe : keyframes) keyframe.lens = keyframe.id < change ? 0 : kPresentLens;
  }
  std::map<std::int64_t, int> index_of;
  for (std::size_t k = 0; k < keyframes.size(); ++k)
    index_of[keyframes[k].id] = static_cast<int>(k);
  const auto indices = [&index_of](const Segment& part) {
    std::vector<int> result;
    for (const Keyframe& keyframe : part.keyframes) {
      const auto found = index_of.find(keyframe.id);
      result.push_back(found == index_of.end() ? -1 : found->second);
    }
    return result;
  };
  Assembly assembly(std::move(keyframes), dated ? history.held_lenses : batch.held_lenses);
  assembly.add(batch, indices(batch), true);
  assembly.add(history, indices(history), false);
  return assembly.build(&camera);
}

std::vector<int> givenUp(const Segment& batch, const Segment& history) {
  std::set<std::int64_t> keyframes;
  for (const Keyframe& keyframe : history.keyframes) keyframes.insert(keyframe.id);
  std::set<std::int64_t> tracks;
  for (const Landmark& landmark : history.landmarks) tracks.insert(landmark.track_id);
  std::vector<std::size_t> views(batch.landmarks.size(), 0);
  const auto isIn = [&](int k) { return keyframes.count(batch.keyframes[k].id); };
  for (const Observation& o : batch.observations) views[o.landmark] += isIn(o.keyframe);
  std::vector<int> given_up;
  for (std::size_t l = 0; l < batch.landmarks.size(); ++l) {
    const Landmark& landmark = batch.landmarks[l];
    if (landmark.anchored) views[l] += isIn(landmark.reference);
    if (views[l] >= 2 && tracks.count(landmark.track_id) == 0) {
      given_up.push_back(static_cast<int>(l));
    }
  }
  return given_up;
}

Segment onlyKeyframes(const Segment& segment, const std::vector<char>& keep) {
  std::vector<Keyframe> keyframes;
  std::vector<int> index(segment.keyframes.size(), -1);
  for (std::size_t k = 0; k < segment.keyframes.size(); ++k) {
    if (keep[k] == 0) continue;
    index[k] = static_cast<int>(keyframes.size());
    keyframes.push_back(segment.keyframes[k]);
  }
  Assembly assembly(std::move(keyframes), segment.held_lenses);
  assembly.add(segment, index, true);
  return assembly.build(nullptr);
}

Segment withoutKeyframe(const Segment& segment, int k) {
  std::vector<char> keep(segment.keyframes.size(), 1);
  keep[k] = 0;
  return onlyKeyframes(segment, keep);
}

Segment newestKeyframes(const Segment& segment, int count) {
  std::vector<char> keep(segment.keyframes.size(), 1);
  const int left_out = static_cast<int>(keep.size()) - count;
  for (int k = 0; k < left_out; ++k) keep[k] = 0;
  return onlyKeyframes(segment, keep);
}

std::vector<Segment> partsOfPresentLens(const Segment& segment, std::size_t count) {
  const auto begin = static_cast<std::size_t>(earlierKeyframes(segment));
  const std::size_t end = segment.keyframes.size();
  std::vector<Segment> parts;
  for (std::size_t part = 0; part < count; ++part) {
    std::vector<char> keep(end, 0);
    const std::size_t last = begin + (part + 1) * (end - begin) / count;
    for (std::size_t k = begin + part * (end - begin) / count; k < last; ++k) keep[k] = 1;
    parts.push_back(onlyKeyframes(segment, keep));
  }
  return parts;
}

std::vector<int> connectedComponents(const Segment& segment) {
  const std::size_t keyframes = segment.keyframes.size();
  const std::vector<int> shared = sharedLandmarks(segment);
  std::vector<int> component(keyframes);
  std::iota(component.begin(), component.end(), 0);
  for (std::size_t j = 0; j < keyframes; ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      if (shared[i * keyframes + j] < kConnectingLandmarks) continue;
      const int first = std::min(component[i], component[j]);
      const int other = std::max(component[i], component[j]);
      std::replace(component.begin(), component.end(), other, first);
    }
  }
  return component;
}

Segment connectedToNewest(const Segment& segment) {
  if (segment.keyframes.empty()) return segment;
  const std::vector<int> component = connectedComponents(segment);
  std::vector<char> keep;
  for (const int c : component) keep.push_back(c == component.back() ? 1 : 0);
  if (std::count(keep.begin(), keep.end(), 0) == 0) return segment;
  return onlyKeyframes(segment, keep);
}

Segment restarted(const Segment& segment, const Segment& start) {
  Segment result = segment;
  std::map<std::int64_t, const Keyframe*> keyframes;
  for (const Keyframe& keyframe : start.keyframes) keyframes[keyframe.id] = &keyframe;
  for (Keyframe& keyframe : result.keyframes) {
    const auto found = keyframes.find(keyframe.id);
    if (found != keyframes.end()) keyframe.world_from_camera = found->second->world_from_camera;
  }
  std::map<std::int64_t, const Landmark*> landmarks;
  for (const Landmark& landmark : start.landmarks) landmarks[landmark.track_id] = &landmark;
  for (Landmark& landmark : result.landmarks) {
    const auto found = landmarks.find(landmark.track_id);
    if (found == landmarks.end() || found->second->reference != landmark.reference) continue;
    landmark.bearing = found->second->bearing;
    landmark.inverse_depth = found->second->inverse_depth;
  }
  return result;
}

Segment asIfTurning(Segment segment, int fixed_keyframes, double inverse_depth) {
  for (std::size_t k = fixed_keyframes; k < segment.keyframes.size(); ++k) {
    segment.keyframes[k].world_from_camera.translation =
        segment.keyframes[fixed_keyframes - 1].world_from_camera.translation;
  }
  for (Landmark& landmark : segment.landmarks) landmark.inverse_depth = inverse_depth;
  return segment;
}

void removeLandmarks(const std::vector<int>& landmarks, Segment* segment) {
  std::vector<int> new_index(segment->landmarks.size(), 0);
  for (const int l : landmarks) new_index[l] = -1;
  int next = 0;
  for (std::size_t l = 0; l < new_index.size(); ++l) {
    if (new_index[l] < 0) continue;
    segment->landmarks[next] = segment->landmarks[l];
    new_index[l] = next++;
  }
  segment->landmarks.resize(next);
  auto& observations = segment->observations;
  observations.erase(
      std::remove_if(observations.begin(), observations.end(),
                     [&](const Observation& o) { return new_index[o.landmark] < 0; }),
      observations.end());
  for (Observation& observation : observations) {
    observation.landmark = new_index[observation.landmark];
  }
}

void keepPoseAndScale(int k, const Rigid3& pose, double inverse_depth, Segment* segment) {
  const Rigid3 solved = segment->keyframes[k].world_from_camera;
  const double scale = typicalInverseDepthAt(k, *segment) / inverse_depth;
  for (Keyframe& keyframe : segment->keyframes) {
    Rigid3 kept_from_camera = solved.inverse() * keyframe.world_from_camera;
    kept_from_camera.translation *= scale;
    keyframe.world_from_camera = pose * kept_from_camera;
  }
  for (Landmark& landmark : segment->landmarks) landmark.inverse_depth /= scale;
}

}  // namespace camera_self_calibration
