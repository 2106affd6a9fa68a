#pragma once

#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// A segment's part in a problem: what is held, and its weight.
struct SegmentBlock {
  Segment* segment = nullptr;
  int fixed_keyframes = 1;   ///< The first so many keyframes keep their poses.
  int fixed_landmark = -1;   ///< This landmark keeps its inverse depth; -1: none.
  double sigma_scale = 1.0;  ///< Multiplies every observation's sigma.
};

/// Everything that is estimated together: the intrinsics are all that the segments share.
struct Problem {
  Camera* camera = nullptr;
  bool estimate_intrinsics = true;
  std::vector<SegmentBlock> blocks;

  /// n_c, or 0 if the intrinsics are held.
  int intrinsicsCount() const { return estimate_intrinsics ? camera->estimatedCount() : 0; }
};

}  // namespace camera_self_calibration
