#include "camera_self_calibration/startup/keyframe_choice.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/map/segment_edit.h"
#include "camera_self_calibration/startup/startup.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

// Half a batch that tells nothing, half that tells much: what tells nothing goes.
TEST(LeastInformative, KeepsWhatTellsTheLens) {
  SegmentOptions scene;
  scene.camera = ordinaryCameras()[1];
  scene.origin = LandmarkOrigin::kInherited;
  scene.keyframes = 24;
  scene.tracks.max_features = 60;
  const SimulatedSegment made = makeSegment(scene, 5);
  const IntrinsicsPrior prior = vaguePrior(made.camera);
  Segment chosen = made.segment, newest = made.segment;
  KeyframeChoiceOptions options;
  options.keep_newest = 6;
  while (chosen.keyframes.size() > 14) {
    chosen = withoutKeyframe(chosen, leastInformative(options, chosen, made.camera, prior));
    newest = withoutKeyframe(newest, 0);
  }
  const auto determinant = [&](Segment segment) {
    Camera camera = made.camera;
    const Problem problem{&camera, true, {freeBlock(&segment, camera)}};
    return std::log(Eigen::MatrixXd(marginalize(problem, 2.0).information).determinant());
  };
  // In nats: 5 would be half the sigma of each parameter.
  EXPECT_GT(determinant(chosen), determinant(newest) + 1.0);
  for (int k = 1; k <= 6; ++k) {
    EXPECT_EQ(chosen.keyframes[14 - k].id, made.segment.keyframes[24 - k].id);
  }
}

}  // namespace
}  // namespace camera_self_calibration
