#pragma once

#include "camera_self_calibration/pipeline/learnt_state.h"

namespace camera_self_calibration {

/// The least that counts as a sound state.
inline LearntState smallState(const Camera& camera, std::uint64_t epoch) {
  LearntState state;
  state.camera = camera;
  state.epoch = epoch;
  Candidate candidate;
  candidate.camera = camera;
  candidate.information =
      IntrinsicsMatrix::Identity(camera.estimatedCount(), camera.estimatedCount());
  candidate.segment.keyframes.resize(2);
  candidate.segment.landmarks.resize(1);
  candidate.segment.observations.resize(1);
  state.segments.push_back(candidate);
  return state;
}

}  // namespace camera_self_calibration
