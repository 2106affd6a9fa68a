#include "camera_self_calibration/startup/connection.h"

#include <algorithm>
#include <numeric>

#include "camera_self_calibration/startup/keyframe_choice.h"

namespace camera_self_calibration {
namespace {

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

}  // namespace camera_self_calibration
