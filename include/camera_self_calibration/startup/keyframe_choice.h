#pragma once

#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/problem.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// `batch` with the keyframes of `history` that come after its last one, and all that history saw
/// of them and of the keyframes of `batch`. Solved poses and landmarks stay as they are; landmarks
/// that are new start on the ray of their first pixel, at the median depth of the known ones there.
/// An empty batch becomes all of history.
Segment extended(const Segment& batch, const Segment& history, const Camera& camera);

/// The keyframes with a `keep` other than 0, and the landmarks that are seen twice there. Depths
/// and bearings that referred to another keyframe move on to the landmark's next one.
Segment onlyKeyframes(const Segment& segment, const std::vector<char>& keep);

/// Leaves keyframe `k` out.
Segment withoutKeyframe(const Segment& segment, int k);

struct KeyframeChoiceOptions {
  int keep_newest = 10;          ///< These stay, so that the next keyframe has what to grow from.
  int trials = 4;                ///< Keyframes considered: the oldest, and those with ...
  int min_bridging_tracks = 25;  ///< ... most tracks common to both neighbours, at least so many.
};

/// The keyframe without which the rest of a solved segment tells most of the intrinsics (largest
/// determinant of their marginal information, `prior` added): what to leave out of a full batch.
int leastInformative(const KeyframeChoiceOptions& options, const Segment& segment,
                     const Camera& camera, const IntrinsicsPrior& prior);

}  // namespace camera_self_calibration
