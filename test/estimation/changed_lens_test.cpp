#include <gtest/gtest.h>

#include <cmath>

#include "camera_self_calibration/estimation/gate.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/linear_segment.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/map/segment_edit.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

constexpr int kKeyframes = 8;
constexpr int kChange = 4;  // the first keyframe with the changed lens

// What a segment would have shown had the lens become `after` before keyframe kChange.
Segment changed(const Segment& segment, const Camera& before, const Camera& after) {
  Segment result = segment;
  for (Observation& observation : result.observations) {
    if (observation.keyframe < kChange) continue;
    const auto ray = before.unproject(observation.pixel);
    if (!ray || !after.project(*ray, &observation.pixel)) ADD_FAILURE() << "not projected";
  }
  for (Landmark& landmark : result.landmarks) {
    if (landmark.reference < kChange) continue;
    const auto ray = before.unproject(landmark.reference_pixel);
    if (!ray || !after.project(*ray, &landmark.reference_pixel)) ADD_FAILURE() << "not projected";
  }
  setEarlierLens(before, kChange, &result);
  return result;
}

Camera zoomed(const Camera& camera, double factor) {
  Intrinsics parameters = camera.parameters();
  parameters.head<2>() *= factor;
  return withParameters(camera, parameters);
}

TEST(ChangedLens, IsEstimatedWithTheEarlierOneHeld) {
  double sum = 0.0;
  int count = 0;
  for (const Camera& before : ordinaryCameras()) {
    for (const LandmarkOrigin origin : {LandmarkOrigin::kAnchored, LandmarkOrigin::kMixed}) {
      const Camera after = zoomed(before, 1.05);
      const SimulatedSegment made = smallSegment(before, origin, 0.2, 21, kKeyframes, 60);
      Segment segment = changed(made.segment, before, after);
      Camera camera = before;
      const Problem problem{&camera, true, {freeBlock(&segment, camera)}};
      ASSERT_TRUE(solve(problem, SolverOptions()).usable);
      const Marginal marginal = marginalize(problem, 0.0);
      const Eigen::VectorXd error = camera.parameters() - after.parameters();
      sum += error.dot(marginal.information * error);
      count += camera.estimatedCount();
      EXPECT_LT(std::abs(error(0)) / after.parameters()(0), 0.01) << toString(before.model());
      EXPECT_TRUE(misfits(problem.blocks[0], camera, 1e-6).empty());
    }
  }
  // The mean of so many squared normalised errors, at four standard deviations.
  EXPECT_NEAR(sum / count, 1.0, 4.0 * std::sqrt(2.0 / count));
}

TEST(ChangedLens, GradientIsTheDerivativeOfTheCost) {
  for (const Camera& before : ordinaryCameras()) {
    const Camera after = zoomed(before, 1.03);
    const SimulatedSegment made = smallSegment(before, LandmarkOrigin::kMixed, 0.2, 5, kKeyframes);
    Segment segment = changed(made.segment, before, after);
    const SegmentBlock block{&segment, 1, 0, 1.0};
    LinearSegment linear;
    linear.linearize(block, before, before.estimatedCount(), 0.0);
    EXPECT_NEAR(linear.cost(), robustCost(block, before, 0.0), 1e-9 * linear.cost());
    for (int i = 0; i < before.estimatedCount(); ++i) {
      const double step = 1e-6 * std::max(1e-2, std::abs(before.parameters()(i)));
      const auto costAt = [&](double sign) {
        Intrinsics parameters = before.parameters();
        parameters(i) += sign * step;
        return robustCost(block, withParameters(before, parameters), 0.0);
      };
      const double derivative = -(costAt(1.0) - costAt(-1.0)) / (2.0 * step);
      EXPECT_NEAR(linear.intrinsicsGradient()(i), derivative, 1e-4 * std::abs(derivative) + 1e-3)
          << toString(before.model()) << " parameter " << i;
    }
  }
}

}  // namespace
}  // namespace camera_self_calibration
