#include "camera_self_calibration/startup/keyframe_choice.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/linear_segment.h"
#include "camera_self_calibration/map/inverse_depth.h"

namespace camera_self_calibration {
namespace {

constexpr double kHuber = 2.0;

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
  explicit Assembly(std::vector<Keyframe> keyframes) { result_.keyframes = std::move(keyframes); }

  // `index` tells for each keyframe of the part its index in the result, -1 if it is left out.
  void add(const Segment& part, const std::vector<int>& index, bool solved);
  // `camera` (may be null) gives the rays of landmarks that are not solved.
  Segment build(const Camera* camera);
  // The first keyframes were taken with another lens (Segment::earlier_camera).
  void setEarlier(const Segment& like, int keyframes);

 private:
  void place(const TrackRecord& record, int reference, const Camera* camera, Landmark* landmark);
  double medianDepth(int k) const;

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

// Median inverse depth of the solved landmarks that keyframe `k` sees, in its own frame.
double Assembly::medianDepth(int k) const {
  std::vector<double> depths;
  for (const auto& [track_id, record] : tracks_) {
    if (record.solved == nullptr || record.sightings.count(k) == 0) continue;
    const Landmark& landmark = record.landmark;
    depths.push_back(transferInverseDepth(
        record.solved->keyframes[landmark.reference].world_from_camera, landmark.bearing,
        landmark.inverse_depth, result_.keyframes[k].world_from_camera));
  }
  return typicalInverseDepth(std::move(depths));
}

void Assembly::place(const TrackRecord& record, int reference, const Camera* camera,
                     Landmark* landmark) {
  *landmark = record.landmark;
  landmark->reference = reference;
  landmark->anchored = record.anchor == reference;
  if (record.solved == nullptr) {
    const Eigen::Vector2d pixel =
        landmark->anchored ? landmark->reference_pixel : record.sightings.begin()->second.pixel;
    if (const auto ray = camera->unproject(pixel)) landmark->bearing = *ray;
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
  std::map<int, double> depth_at;  // where unsolved landmarks start, by keyframe
  for (auto& [track_id, record] : tracks_) {
    if (record.sightings.empty()) continue;
    const int first = record.sightings.begin()->first;
    const bool anchored = record.anchor >= 0 && record.anchor < first;
    if (!anchored && record.sightings.size() < 2) continue;
    const int index = static_cast<int>(result_.landmarks.size());
    Landmark landmark;
    place(record, anchored ? record.anchor : first, camera, &landmark);
    if (record.solved == nullptr) {
      const auto [entry, is_new] = depth_at.try_emplace(landmark.reference, 0.0);
      if (is_new) entry->second = medianDepth(landmark.reference);
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

void Assembly::setEarlier(const Segment& like, int keyframes) {
  if (!like.earlier_camera || keyframes <= 0) return;
  result_.earlier_camera = like.earlier_camera;
  result_.earlier_keyframes = keyframes;
}

std::vector<int> commonToNeighbours(const Segment& segment) {
  const int count = static_cast<int>(segment.keyframes.size());
  std::vector<int> common(count, 0);
  std::vector<std::vector<char>> sees(segment.landmarks.size(), std::vector<char>(count, 0));
  for (const Observation& o : segment.observations) sees[o.landmark][o.keyframe] = 1;
  for (std::size_t l = 0; l < sees.size(); ++l) {
    if (segment.landmarks[l].anchored) sees[l][segment.landmarks[l].reference] = 1;
    for (int k = 1; k + 1 < count; ++k) common[k] += sees[l][k - 1] & sees[l][k + 1];
  }
  return common;
}

}  // namespace

Segment extended(const Segment& batch, const Segment& history, const Camera& camera) {
  if (batch.keyframes.empty()) return history;
  std::vector<Keyframe> keyframes = batch.keyframes;
  for (const Keyframe& keyframe : history.keyframes) {
    if (keyframe.id > batch.keyframes.back().id) keyframes.push_back(keyframe);
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
  // History dates a change of the lens only where it reaches back beyond it.
  const int present = history.earlier_keyframes;
  const bool dated = present > 0 && present < static_cast<int>(history.keyframes.size());
  const auto before = [&](const Keyframe& k) { return k.id < history.keyframes[present].id; };
  const auto earlier =
      dated ? std::count_if(keyframes.begin(), keyframes.end(), before) : batch.earlier_keyframes;
  Assembly assembly(std::move(keyframes));
  assembly.setEarlier(dated ? history : batch, static_cast<int>(earlier));
  assembly.add(batch, indices(batch), true);
  assembly.add(history, indices(history), false);
  return assembly.build(&camera);
}

Segment onlyKeyframes(const Segment& segment, const std::vector<char>& keep) {
  std::vector<Keyframe> keyframes;
  std::vector<int> index(segment.keyframes.size(), -1);
  int earlier = 0;
  for (std::size_t k = 0; k < segment.keyframes.size(); ++k) {
    if (keep[k] == 0) continue;
    index[k] = static_cast<int>(keyframes.size());
    keyframes.push_back(segment.keyframes[k]);
    earlier += segment.isEarlier(static_cast<int>(k)) ? 1 : 0;
  }
  Assembly assembly(std::move(keyframes));
  assembly.setEarlier(segment, earlier);
  assembly.add(segment, index, true);
  return assembly.build(nullptr);
}

Segment withoutKeyframe(const Segment& segment, int k) {
  std::vector<char> keep(segment.keyframes.size(), 1);
  keep[k] = 0;
  return onlyKeyframes(segment, keep);
}

int leastInformative(const KeyframeChoiceOptions& options, const Segment& segment,
                     const Camera& camera, const IntrinsicsPrior& prior) {
  const std::vector<int> bridging = commonToNeighbours(segment);
  std::vector<std::pair<int, int>> order;
  const int end = static_cast<int>(segment.keyframes.size()) - options.keep_newest;
  for (int k = 1; k < end; ++k) {
    if (bridging[k] >= options.min_bridging_tracks) order.push_back({-bridging[k], k});
  }
  std::sort(order.begin(), order.end());
  order.insert(order.begin(), {0, 0});
  order.resize(std::min(order.size(), static_cast<std::size_t>(options.trials)));
  int best = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (const auto& [unused, k] : order) {
    Segment rest = withoutKeyframe(segment, k);
    LinearSegment linear;
    linear.linearize(freeBlock(&rest, camera), camera, camera.estimatedCount(), kHuber);
    linear.eliminate(0.0);
    IntrinsicsMatrix information = linear.reducedHessian();
    information.diagonal() += prior.weights(camera.estimatedCount());
    const double determinant =
        Eigen::LDLT<Eigen::MatrixXd>(information).vectorD().array().max(1e-300).log().sum();
    if (!(determinant > most)) continue;
    most = determinant;
    best = k;
  }
  return best;
}

}  // namespace camera_self_calibration
