#include "camera_self_calibration/estimation/rigid_gate.h"

#include "camera_self_calibration/estimation/gate.h"
#include "camera_self_calibration/estimation/solver.h"

namespace camera_self_calibration {

std::vector<int> nonRigidTracks(Segment* segment, const Camera& camera) {
  Camera held = camera;
  SegmentBlock block;
  block.segment = segment;
  block.fixed_keyframes = static_cast<int>(segment->keyframes.size());
  block.sigma_scale = provisionalScale(block, camera);
  SolverOptions depths;
  depths.max_iterations = 5;
  depths.precision = kRoughPrecision;
  solve({&held, false, {block}}, depths);
  block.sigma_scale = 1.0;
  block.sigma_scale = provisionalScale(block, camera);
  return grossMisfits(block, camera, kGrossSigmas, kGrossShare * camera.width());
}

}  // namespace camera_self_calibration
