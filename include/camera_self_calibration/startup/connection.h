#pragma once

#include <vector>

#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// Landmarks that two keyframes must share to be connected. n of them measure the motion between
/// two views 4 n times, for its 5 unknowns up to scale and 3 n of their positions: from 6 on it is
/// over-determined.
constexpr int kConnectingLandmarks = 6;

/// For each keyframe, a number that it has in common with those it is connected to, directly or
/// through others: the index of the first of them.
std::vector<int> connectedComponents(const Segment& segment);

/// The keyframes that are connected to the newest one, and what they see. Poses in pieces that no
/// track connects are free against each other: they tell nothing together and make a solution
/// singular.
Segment connectedToNewest(const Segment& segment);

}  // namespace camera_self_calibration
