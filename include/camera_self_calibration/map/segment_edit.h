#pragma once

#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/map/segment.h"

// What is done to a Segment without estimating anything.

namespace camera_self_calibration {

/// The first `keyframes` keyframes were taken with the lens `earlier` before the camera changed,
/// all others with the present one.
void setEarlierLens(const Camera& earlier, int keyframes, Segment* segment);

/// All keyframes were taken with the present lens.
void setOneLens(Segment* segment);

/// How many keyframes, the first ones, were taken before the camera changed (setEarlierLens).
int earlierKeyframes(const Segment& segment);

/// The first `keyframes` keyframes of a segment, with the landmarks that have at least `min_views`
/// observations there (the reference keyframe of an anchored one not counted).
/// `landmark_index` tells for each landmark its index in the whole segment.
Segment prefixOf(const Segment& segment, int keyframes, int min_views,
                 std::vector<int>* landmark_index);

/// Takes poses and landmarks of a prefix back into the whole segment.
void adoptPrefix(const Segment& prefix, const std::vector<int>& landmark_index, Segment* segment);

/// `batch` with the keyframes of `history` that come after its last one, and all that history saw
/// of them and of the keyframes of `batch`. Solved poses and landmarks stay as they are; landmarks
/// that are new start on the ray of their first pixel, at the median inverse depth of the known
/// ones there. An empty batch becomes all of history.
Segment extended(const Segment& batch, const Segment& history, const Camera& camera);

/// The landmarks of `batch` that `history`, a part of the map, no longer holds though it has at
/// least two of the keyframes that see them: the map has given them up.
std::vector<int> givenUp(const Segment& batch, const Segment& history);

/// The keyframes with a `keep` other than 0, and the landmarks that are seen twice there. Depths
/// and bearings that referred to another keyframe move on to the landmark's next one.
Segment onlyKeyframes(const Segment& segment, const std::vector<char>& keep);

/// Leaves keyframe `k` out.
Segment withoutKeyframe(const Segment& segment, int k);

/// The last `count` keyframes, or all where there are fewer, as onlyKeyframes().
Segment newestKeyframes(const Segment& segment, int count);

/// What the segment holds of the lens of its newest keyframes, in `count` parts of about as many
/// keyframes, one after the other, as onlyKeyframes().
std::vector<Segment> partsOfPresentLens(const Segment& segment, std::size_t count);

/// Landmarks that two keyframes must share to be connected. n of them measure the motion between
/// two views 4 n times, for its 5 unknowns up to scale and 3 n of their positions: from 6 on it is
/// over-determined.
inline constexpr int kConnectingLandmarks = 6;

/// For each keyframe, a number that it has in common with those it is connected to, directly or
/// through others: the index of the first of them.
std::vector<int> connectedComponents(const Segment& segment);

/// The keyframes that are connected to the newest one, and what they see. Poses in pieces that no
/// track connects are free against each other: they tell nothing together and make a solution
/// singular.
Segment connectedToNewest(const Segment& segment);

/// The observations of `segment` with the poses and landmarks of `start`, which it is a part of,
/// and which were estimated with other intrinsics.
Segment restarted(const Segment& segment, const Segment& start);

/// The segment as if the camera had turned on the spot after its first `fixed_keyframes` (one at
/// least), before points of equal inverse depth [1/map unit]. Where it did turn, depths and
/// positions come of noise, and a solution that starts from them ends in a wrong minimum once the
/// camera moves on.
Segment asIfTurning(Segment segment, int fixed_keyframes, double inverse_depth);

/// Removes landmarks and their observations; indices of the others close up, so that
/// `fixed_landmark` of blocks made before no longer holds.
void removeLandmarks(const std::vector<int>& landmarks, Segment* segment);

/// Moves and scales a segment so that keyframe `k` has this pose, and what it sees this typical
/// inverse depth there (typicalInverseDepthAt) [1/map unit].
void keepPoseAndScale(int k, const Rigid3& pose, double inverse_depth, Segment* segment);

}  // namespace camera_self_calibration
