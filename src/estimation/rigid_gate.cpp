#include "camera_self_calibration/estimation/rigid_gate.h"

#include "camera_self_calibration/estimation/gate.h"
#include "camera_self_calibration/estimation/landmark_solver.h"
#include "camera_self_calibration/estimation/solver.h"

namespace camera_self_calibration {
namespace {

// Where residuals shrank by more, depths that rest at their old scale are too rough at the new one.
constexpr double kSettled = 0.5;

double residualScale(SegmentBlock block, const Camera& camera) {
  block.sigma_scale = 1.0;
  return provisionalScale(block, camera);
}

}  // namespace

std::vector<int> nonRigidTracks(Segment* segment, const Camera& camera) {
  SegmentBlock block;
  block.segment = segment;
  block.fixed_keyframes = static_cast<int>(segment->keyframes.size());
  LandmarkSolverOptions depths;
  depths.precision = kRoughPrecision;
  double scale = residualScale(block, camera);
  do {
    block.sigma_scale = scale;
    solveLandmarks(block, camera, depths);
    scale = residualScale(block, camera);
  } while (scale < kSettled * block.sigma_scale);
  block.sigma_scale = scale;
  return grossMisfits(block, camera, kGrossSigmas, kGrossShare * camera.longerSide());
}

}  // namespace camera_self_calibration
