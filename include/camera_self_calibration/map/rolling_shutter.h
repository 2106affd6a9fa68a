#pragma once

#include <Eigen/Core>
#include <vector>

#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// Times between rows that an image has.
inline int rowSteps(int image_height) { return image_height > 1 ? image_height - 1 : 1; }

/// Which features of a segment move as a rigid scene does: for each keyframe, those whose reference
/// it is, then its observations, each in their order in the segment.
using SceneMembers = std::vector<std::vector<bool>>;

/// Puts a pixel where a global shutter would have seen it at the time of the middle row, by the
/// feature's own motion (asSeenAtOnce); 0: back where it was seen. `line_delay_s` [s] is positive
/// where the upper rows are read first.
void placePixel(double line_delay_s, int image_height, Eigen::Vector2d* pixel, RowShift* shift);

/// The same with all pixels of a segment. Poses are then those of the middle row.
void setLineDelay(double line_delay_s, int image_height, Segment* segment);

/// The same for a segment that was solved: each keyframe's features move as a rigid scene does
/// (fitCameraMotion, by those whose motion is known best). A feature's own motion is a difference
/// of noisy pixels: times the line delay its noise looks like an error that grows with the line
/// delay, which is then found too short. What was seen to move otherwise (movesWithScene) keeps its
/// own motion. Returns which features move with the scene.
SceneMembers setLineDelayOfScene(double line_delay_s, const Camera& camera, Segment* segment);

/// The same with `members` as they were found at another line delay: where costs are compared that
/// differ in the line delay alone, a feature that changes sides would add a step of its own.
void setLineDelayOfScene(double line_delay_s, const Camera& camera, const SceneMembers& members,
                         Segment* segment);

}  // namespace camera_self_calibration
