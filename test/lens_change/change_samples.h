#pragma once

#include <gtest/gtest.h>

#include "camera_self_calibration/queue/candidate_window.h"
#include "camera_self_calibration/queue/segment_queue.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {

/// A window of the trajectory as the map would hand it over: ten keyframes, 60 features.
inline SimulatedSegment windowOf(const Camera& lens, std::uint64_t seed,
                                 MotionKind motion = MotionKind::kHandheld) {
  SegmentOptions options;
  options.motion = motion;
  options.camera = lens;
  options.tracks.max_features = 60;
  options.tracks.pixel_sigma = 0.3;
  return makeSegment(options, seed);
}

inline Candidate candidateOf(const Camera& lens, const Camera& start, std::uint64_t seed,
                             MotionKind motion = MotionKind::kHandheld) {
  Candidate candidate = evaluateCandidate(
      CandidateOptions(), perturbed(windowOf(lens, seed, motion).segment, {}, seed), start);
  // Windows of different seeds stand for different times.
  for (Keyframe& keyframe : candidate.segment.keyframes) {
    keyframe.stamp_ns += static_cast<std::int64_t>(seed) * 10000000000;
  }
  candidate.segment.sequence = static_cast<std::int64_t>(seed);
  return candidate;
}

/// With room for more segments than a test has.
inline SegmentQueue roomyQueue(int threads = 1) {
  return SegmentQueue(QueuePolicy(20, 0.95), threads);
}

inline Camera zoomed(const Camera& camera, double factor) {
  Intrinsics parameters = camera.parameters();
  parameters.head<2>() *= factor;
  return withParameters(camera, parameters);
}

/// The segment as seen by a lens that becomes `after` before keyframe `change`.
inline Segment withChange(Segment segment, const Camera& before, const Camera& after, int change) {
  for (Observation& observation : segment.observations) {
    if (observation.keyframe < change) continue;
    const auto ray = before.unproject(observation.pixel);
    if (!ray || !after.project(*ray, &observation.pixel)) ADD_FAILURE() << "not projected";
  }
  for (Landmark& landmark : segment.landmarks) landmark.anchored = false;
  return segment;
}

}  // namespace camera_self_calibration
