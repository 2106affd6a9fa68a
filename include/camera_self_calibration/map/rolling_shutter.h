#pragma once

#include <Eigen/Core>

#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// Times between rows that an image has.
inline int rowSteps(int image_height) { return image_height > 1 ? image_height - 1 : 1; }

/// Puts a pixel where a global shutter would have seen it at the time of the middle row, by the
/// feature's own motion (asSeenAtOnce); 0: back where it was seen. `line_delay_s` [s] is positive
/// where the upper rows are read first.
void placePixel(double line_delay_s, int image_height, Eigen::Vector2d* pixel, RowShift* shift);

/// The same with all pixels of a segment. Poses are then those of the middle row.
void setLineDelay(double line_delay_s, int image_height, Segment* segment);

/// The same for a segment that was solved: each keyframe's features move as a rigid scene does
/// (fitCameraMotion, by those whose motion is known best). A feature's own motion is a difference
/// of noisy pixels: times the line delay its noise looks like an error that grows with the line
/// delay, which is then found too short.
void setLineDelayOfScene(double line_delay_s, const Camera& camera, Segment* segment);

}  // namespace camera_self_calibration
