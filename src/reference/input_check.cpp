#include "input_check.h"

#include <cmath>

namespace camera_self_calibration {
namespace {

bool isIndex(int index, std::size_t size) {
  return index >= 0 && static_cast<std::size_t>(index) < size;
}

std::string poseProblem(const Keyframe& keyframe) {
  const Rigid3& pose = keyframe.world_from_camera;
  if (!pose.rotation.coeffs().allFinite() || !pose.translation.allFinite()) {
    return "has a pose that is not finite";
  }
  if (std::abs(pose.rotation.norm() - 1.0) > 1e-6) return "has a quaternion that is not unit";
  return "";
}

std::string landmarkProblem(const Landmark& landmark, std::size_t keyframes) {
  if (!isIndex(landmark.reference, keyframes)) return "refers to a keyframe that does not exist";
  if (!std::isfinite(landmark.inverse_depth)) return "has an inverse depth that is not finite";
  if (!landmark.anchored && !(std::abs(landmark.bearing.norm() - 1.0) < 1e-6)) {
    return "has a bearing that is not unit";
  }
  return "";
}

std::string observationProblem(const Observation& observation, const Segment& segment) {
  if (!isIndex(observation.landmark, segment.landmarks.size())) {
    return "refers to a landmark that does not exist";
  }
  if (!isIndex(observation.keyframe, segment.keyframes.size())) {
    return "refers to a keyframe that does not exist";
  }
  if (!(observation.sigma > 0.0) || !std::isfinite(observation.sigma)) {
    return "has a sigma that is not positive";
  }
  if (!observation.pixel.allFinite()) return "has a pixel that is not finite";
  const Landmark& landmark = segment.landmarks[observation.landmark];
  if (landmark.anchored && landmark.reference == observation.keyframe) {
    return "lies in the reference keyframe of an anchored landmark, whose pixel is exact";
  }
  return "";
}

// The first complaint about an item, with its name and number in front.
template <typename Items, typename Check>
std::string firstProblem(const std::string& name, const Items& items, const Check& check) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string problem = check(items[i]);
    if (!problem.empty()) return name + " " + std::to_string(i) + " " + problem;
  }
  return "";
}

std::string segmentProblem(const BatchSegment& batch) {
  if (!batch.segment) return "is a null pointer";
  const Segment& segment = *batch.segment;
  if (!(batch.sigma_scale > 0.0) || !std::isfinite(batch.sigma_scale)) {
    return "has a sigma_scale that is not positive";
  }
  if (batch.fixed_landmark >= static_cast<int>(segment.landmarks.size())) {
    return "fixes a landmark that does not exist";
  }
  std::string problem = firstProblem("keyframe", segment.keyframes, poseProblem);
  if (problem.empty()) {
    problem = firstProblem("landmark", segment.landmarks, [&](const Landmark& landmark) {
      return landmarkProblem(landmark, segment.keyframes.size());
    });
  }
  if (problem.empty()) {
    problem = firstProblem("observation", segment.observations, [&](const Observation& seen) {
      return observationProblem(seen, segment);
    });
  }
  return problem.empty() ? "" : "is malformed: " + problem;
}

}  // namespace

std::string inputProblem(const std::vector<BatchSegment>& segments, const Camera& camera) {
  if (!camera.valid()) return "the camera's parameters are not valid";
  return firstProblem("segment", segments, segmentProblem);
}

}  // namespace camera_self_calibration
