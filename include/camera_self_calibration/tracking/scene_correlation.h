#pragma once

#include <vector>

#include "camera_self_calibration/tracking/local_motion.h"
#include "camera_self_calibration/tracking/pyramid.h"

namespace camera_self_calibration {

/// How much an image has in common with the one before it. Features alone cannot tell: after a cut,
/// those of a repeated pattern are found again, each on another part of it.
class SceneCorrelation {
 public:
  /// Coefficient of correlation (-1 to 1) between the gray values of both images at a coarse level,
  /// where `motion` leads those of the first: median over blocks, so that brightness and what moves
  /// by itself in less than half of the image do not count. About 0 for two unrelated images; 1
  /// where too few blocks have the contrast to tell.
  double between(const ImagePyramid& before, const ImagePyramid& now,
                 const LocalMotion& motion) const;

 private:
  mutable std::vector<double> correlations_;  // of the blocks, to spare allocations
};

}  // namespace camera_self_calibration
