#pragma once

#include <limits>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/problem.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

struct GrowthOptions {
  int free_after_keyframes = 4;  ///< From so many keyframes on the intrinsics are estimated.
  double max_inverse_depth_ratio = 20.0;  ///< To the median; beyond, a depth starts over.
  IntrinsicsPrior prior = {};             ///< Vague, against runaways.
  bool two_views = true;                  ///< Whether epipolar geometry is a second beginning.
};

/// Whether an estimate has left what any lens can be. Depths and positions then grow without end,
/// the way back is lost, and what they multiply to overflows.
bool ranAway(const Camera& camera);

/// One step of growing a solution: keyframe `k` starts at the pose of the one before, landmarks
/// that appear there at the median depth; its pose is solved alone, then all keyframes up to it
/// jointly, the intrinsics among them if there are enough. Depths that run away (not positive, or
/// far above the median) start over. Where the first four keyframes do not fit, they are grown once
/// more from the epipolar geometry of the first two, and the solution of less cost stays. Returns
/// the robust cost.
double growByKeyframe(const GrowthOptions& options, int k, Segment* segment, Camera* camera);

/// Solves a segment from no knowledge but `camera`'s guess, keyframe by keyframe (all poses and
/// depths in it are overwritten). Returns the final robust cost; infinite where it failed. Once the
/// intrinsics are estimated and the cost is above `give_up_above`, the rest is left out, and the
/// cost so far returned: that of the best solution only rises with the keyframes. It is no strict
/// bound, since a solution that is short of its optimum may still get there.
double bootstrap(const GrowthOptions& options, Segment* segment, Camera* camera,
                 double give_up_above = std::numeric_limits<double>::infinity());

}  // namespace camera_self_calibration
