#pragma once

#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/problem.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

struct KeyframeChoiceOptions {
  int keep_newest = 10;          ///< These stay, so that the next keyframe has what to grow from.
  int trials = 4;                ///< Keyframes considered: the oldest, and those with ...
  int min_bridging_tracks = 25;  ///< ... most tracks common to both neighbours, at least so many.
};

/// The keyframe without which the rest of a solved segment tells most of the intrinsics (largest
/// determinant of their marginal information, `prior` added): what to leave out of a full batch.
int leastInformative(const KeyframeChoiceOptions& options, const Segment& segment,
                     const Camera& camera, const IntrinsicsPrior& prior, int threads = 1);

}  // namespace camera_self_calibration
