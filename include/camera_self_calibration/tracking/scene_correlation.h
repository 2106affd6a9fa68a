#pragma once

#include "camera_self_calibration/tracking/local_motion.h"
#include "camera_self_calibration/tracking/pyramid.h"

namespace camera_self_calibration {

/// How much an image has in common with the one before it: coefficient of correlation (-1 to 1)
/// between the gray values of both at a coarse level, where `motion` leads those of the first; the
/// median over blocks, so that brightness and what moves by itself in less than half of the image
/// do not count. About 0 for two unrelated images; 1 where too few blocks have the contrast to
/// tell. Features alone cannot tell: after a cut, those of a repeated pattern are found again, each
/// on another part of it.
double sceneCorrelation(const ImagePyramid& before, const ImagePyramid& now,
                        const LocalMotion& motion);

}  // namespace camera_self_calibration
