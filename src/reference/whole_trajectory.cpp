#include "camera_self_calibration/reference/whole_trajectory.h"

#include <algorithm>

#include "camera_self_calibration/map/rolling_shutter.h"

namespace camera_self_calibration {

// Map units of the part per unit of the window, from the length of the way along the keyframes
// that both know; 1 where they have not moved.
double WholeTrajectory::scaleOf(const Part& part, const Segment& window) {
  double own_way = 0.0;
  double window_way = 0.0;
  for (std::size_t k = 1; k < window.keyframes.size(); ++k) {
    const auto a = part.keyframe_index.find(window.keyframes[k - 1].id);
    const auto b = part.keyframe_index.find(window.keyframes[k].id);
    if (a == part.keyframe_index.end() || b == part.keyframe_index.end()) continue;
    const auto step = [](const Keyframe& from, const Keyframe& to) {
      return (to.world_from_camera.translation - from.world_from_camera.translation).norm();
    };
    own_way += step(part.segment.keyframes[a->second], part.segment.keyframes[b->second]);
    window_way += step(window.keyframes[k - 1], window.keyframes[k]);
  }
  return own_way > 0.0 && window_way > 0.0 ? own_way / window_way : 1.0;
}

// Each new keyframe goes where it stands relative to the one before it in the window.
void WholeTrajectory::addKeyframes(const Segment& window, double scale, Part* part) {
  for (std::size_t k = 0; k < window.keyframes.size(); ++k) {
    Keyframe keyframe = window.keyframes[k];
    if (part->keyframe_index.count(keyframe.id) > 0) continue;
    if (k > 0) {
      const Keyframe& before = window.keyframes[k - 1];
      Rigid3 before_from_camera = before.world_from_camera.inverse() * keyframe.world_from_camera;
      before_from_camera.translation *= scale;
      const int index = part->keyframe_index.at(before.id);
      keyframe.world_from_camera =
          part->segment.keyframes[index].world_from_camera * before_from_camera;
    }
    part->keyframe_index[keyframe.id] = static_cast<int>(part->segment.keyframes.size());
    keyframe.lens = kPresentLens;  // a part holds no lens
    part->segment.keyframes.push_back(keyframe);
  }
}

// The newer window has its pixels freed of the newer line delay.
void WholeTrajectory::learnMotion(const Observation& seen, std::vector<Observation>* known) {
  for (Observation& observation : *known) {
    if (observation.keyframe != seen.keyframe) continue;
    observation.pixel = seen.pixel;
    observation.shift = seen.shift;
  }
}

void WholeTrajectory::setLineDelay(double line_delay_s, int image_height) {
  for (Part& part : parts_) {
    camera_self_calibration::setLineDelay(line_delay_s, image_height, &part.segment);
    for (std::vector<Observation>& seen : part.observations) {
      for (Observation& observation : seen) {
        placePixel(line_delay_s, image_height, &observation.pixel, &observation.shift);
      }
    }
  }
}

void WholeTrajectory::add(const Segment& window) {
  if (window.keyframes.empty()) return;
  const auto known = [&](const Keyframe& keyframe) {
    return !parts_.empty() && parts_.back().keyframe_index.count(keyframe.id) > 0;
  };
  if (std::none_of(window.keyframes.begin(), window.keyframes.end(), known)) {
    parts_.emplace_back();
  }
  Part& part = parts_.back();
  const double scale = scaleOf(part, window);
  const auto first_new = static_cast<int>(part.segment.keyframes.size());
  addKeyframes(window, scale, &part);
  keyframes_ += static_cast<int>(part.segment.keyframes.size()) - first_new;

  std::vector<char> is_new(window.landmarks.size(), 0);
  for (std::size_t l = 0; l < window.landmarks.size(); ++l) {
    Landmark landmark = window.landmarks[l];
    const int index = static_cast<int>(part.segment.landmarks.size());
    is_new[l] = part.landmark_index.try_emplace(landmark.track_id, index).second ? 1 : 0;
    if (is_new[l] == 0) continue;
    landmark.reference = part.keyframe_index.at(window.keyframes[landmark.reference].id);
    landmark.inverse_depth /= scale;
    part.segment.landmarks.push_back(landmark);
    part.observations.emplace_back();
  }
  for (Observation seen : window.observations) {
    const int keyframe = part.keyframe_index.at(window.keyframes[seen.keyframe].id);
    const int index = part.landmark_index.at(window.landmarks[seen.landmark].track_id);
    const bool known_already = is_new[seen.landmark] == 0 && keyframe < first_new;
    seen.landmark = index;
    seen.keyframe = keyframe;
    std::vector<Observation>& all = part.observations[index];
    if (known_already) {
      learnMotion(seen, &all);
    } else {
      all.push_back(seen);
    }
  }
}

std::vector<Segment> WholeTrajectory::parts() const {
  std::vector<Segment> segments;
  for (const Part& part : parts_) {
    segments.push_back(part.segment);
    for (const std::vector<Observation>& seen : part.observations) {
      segments.back().observations.insert(segments.back().observations.end(), seen.begin(),
                                          seen.end());
    }
  }
  return segments;
}

void WholeTrajectory::update(const std::vector<Segment>& solved) {
  for (std::size_t s = 0; s < std::min(solved.size(), parts_.size()); ++s) {
    Part& part = parts_[s];
    for (const Keyframe& keyframe : solved[s].keyframes) {
      const auto found = part.keyframe_index.find(keyframe.id);
      if (found == part.keyframe_index.end()) continue;
      part.segment.keyframes[found->second].world_from_camera = keyframe.world_from_camera;
    }
    for (const Landmark& landmark : solved[s].landmarks) {
      const auto found = part.landmark_index.find(landmark.track_id);
      if (found != part.landmark_index.end()) {
        part.segment.landmarks[found->second] = landmark;
      }
    }
  }
}

}  // namespace camera_self_calibration
