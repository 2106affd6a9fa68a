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
  // A tenth of a sigma, where gross misfits are many; outlying tracks alone settle beyond the cost.
  depths.step_tolerance = 0.1;
  depths.cost_tolerance = 5e-3;
  solve({&held, false, {block}}, depths);
  block.sigma_scale = 1.0;
  block.sigma_scale = provisionalScale(block, camera);
  return grossMisfits(block, camera, kGrossSigmas, kGrossShare * camera.width());
}

}  // namespace camera_self_calibration
