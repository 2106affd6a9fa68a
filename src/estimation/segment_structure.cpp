#include "camera_self_calibration/estimation/segment_structure.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace camera_self_calibration {

void SegmentStructure::build(const SegmentBlock& block) {
  const Segment& segment = *block.segment;
  const std::size_t keyframes = segment.keyframes.size();
  free_poses = std::max(0, static_cast<int>(keyframes) - block.fixed_keyframes);
  pairs.clear();
  entry_poses.clear();
  pair_of_.assign(keyframes * keyframes, -1);
  entry_of_.assign(keyframes, -1);
  landmark_of_.assign(keyframes, -1);
  placeLandmarks(block);
  observations.resize(segment.observations.size());
  // Landmark by landmark, so that the entries of each lie side by side.
  sortByLandmark(segment);
  for (const int o : order_) {
    placeObservation(block, segment.observations[o], &observations[o]);
  }
  sortByPoses();
}

void SegmentStructure::sortByPoses() {
  elimination_order.resize(landmarks.size());
  std::iota(elimination_order.begin(), elimination_order.end(), 0);
  std::sort(elimination_order.begin(), elimination_order.end(), [this](int a, int b) {
    const auto key = [this](int l) {
      return std::make_tuple(landmarks[l].first_pose, landmarks[l].last_pose, l);
    };
    return key(a) < key(b);
  });
}

void SegmentStructure::sortByLandmark(const Segment& segment) {
  std::vector<int>& next = next_;
  next.assign(segment.landmarks.size() + 1, 0);
  for (const Observation& observation : segment.observations) ++next[observation.landmark + 1];
  for (std::size_t l = 1; l < next.size(); ++l) next[l] += next[l - 1];
  order_.resize(segment.observations.size());
  for (std::size_t o = 0; o < order_.size(); ++o) {
    order_[next[segment.observations[o].landmark]++] = static_cast<int>(o);
  }
}

void SegmentStructure::placeLandmarks(const SegmentBlock& block) {
  const Segment& segment = *block.segment;
  landmarks.resize(segment.landmarks.size());
  landmark_rows = 0;
  for (std::size_t l = 0; l < landmarks.size(); ++l) {
    LandmarkPlace& place = landmarks[l];
    place = LandmarkPlace();
    place.dimension = segment.landmarks[l].anchored ? 1 : 3;
    place.inverse_depth_fixed = static_cast<int>(l) == block.fixed_landmark;
    place.reference_free = segment.landmarks[l].reference >= block.fixed_keyframes;
    place.row = landmark_rows;
    landmark_rows += place.rows();
  }
}

void SegmentStructure::placeObservation(const SegmentBlock& block, const Observation& observation,
                                        ObservationPlace* place) {
  const int reference = block.segment->landmarks[observation.landmark].reference;
  const int observing = observation.keyframe;
  const int keyframes = static_cast<int>(entry_of_.size());
  int& pair = pair_of_[reference * keyframes + observing];
  if (pair < 0) {
    pair = static_cast<int>(pairs.size());
    pairs.push_back({reference, observing});
  }
  *place = {pair, -1};
  // In its own reference keyframe a point's pixel does not depend on any pose.
  if (reference == observing) return;
  LandmarkPlace& landmark = landmarks[observation.landmark];
  const auto enter = [&](int keyframe) {
    if (landmark_of_[keyframe] != observation.landmark) {
      if (landmark.entries == 0) landmark.first_entry = static_cast<int>(entry_poses.size());
      landmark_of_[keyframe] = observation.landmark;
      entry_of_[keyframe] = landmark.first_entry + landmark.entries++;
      const int pose = keyframe - block.fixed_keyframes;
      entry_poses.push_back(pose);
      landmark.first_pose = std::min(landmark.first_pose, pose);
      landmark.last_pose = std::max(landmark.last_pose, pose);
    }
    return entry_of_[keyframe];
  };
  if (landmark.reference_free) enter(reference);
  if (observing >= block.fixed_keyframes) place->entry = enter(observing);
}

}  // namespace camera_self_calibration
