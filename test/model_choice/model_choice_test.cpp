#include "camera_self_calibration/model_choice/model_choice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/model_choice/held_out.h"
#include "queue/sample_queues.h"

namespace camera_self_calibration {
namespace {

const Camera kPinhole = camera640(CameraModel::kPinhole, {420, 415, 325, 236});
const Camera kRadtan = camera640(CameraModel::kRadtan, {400, 404, 315, 243, -0.25, 0.05, 0, 0});

Camera as(CameraModel model, const Camera& camera) { return fitCamera(camera, model)->camera; }

// What leaveOneOut says of each segment, the long way: fitted without it, then held.
double heldOutCost(const std::vector<Segment>& segments, std::size_t out, const JointFit& all) {
  std::vector<Segment> others = all.segments;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(out));
  Camera camera = all.camera;
  Problem problem;
  problem.camera = &camera;
  for (Segment& segment : others) problem.blocks.push_back(freeBlock(&segment, camera));
  EXPECT_TRUE(solve(problem, SolverOptions()).usable);
  Segment own = all.segments[out];
  problem.blocks = {freeBlock(&own, camera)};
  problem.estimate_intrinsics = false;
  EXPECT_EQ(segments.size(), others.size() + 1);
  return solve(problem, SolverOptions()).final_cost;
}

TEST(HeldOut, IsTheCostUnderTheOthersEstimate) {
  const std::vector<Segment> segments = separateSegments(kRadtan, 4);
  const JointFit fit = fitJointly(segments, kRadtan, 1);
  ASSERT_TRUE(fit.usable);
  const HeldOut held = leaveOneOut(segments, fit.tracks, fit, 2);
  ASSERT_TRUE(held.usable);
  ASSERT_EQ(held.cost.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const double exact = heldOutCost(segments, i, fit);
    EXPECT_NEAR(held.cost[i], exact, 0.02 * exact) << i;
  }
}

TEST(HeldOut, AModelThatDoesNotFitPredictsWorse) {
  const std::vector<Segment> segments = separateSegments(kRadtan, 3);
  const JointFit right = fitJointly(segments, kRadtan, 1);
  const JointFit wrong = fitJointly(segments, as(CameraModel::kPinhole, kRadtan), 1);
  ASSERT_TRUE(right.usable && wrong.usable);
  EXPECT_GT(wrong.tracks[0].unexplained_sigma, right.tracks[0].unexplained_sigma);
  const HeldOut a = leaveOneOut(segments, right.tracks, right, 1);
  const HeldOut b = leaveOneOut(segments, right.tracks, wrong, 1);
  EXPECT_GT(b.total(), 2.0 * a.total());
}

TEST(ModelChoice, FindsDistortionThatTheModelLacks) {
  ModelChoice choice{ModelChoiceOptions()};
  const std::vector<Segment> segments = separateSegments(kRadtan, 4);
  const auto camera = choice.consider(40, segments, as(CameraModel::kFov, kRadtan), 1);
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->model(), CameraModel::kRadtan);
  EXPECT_EQ(camera->estimatedCount(), 8);
  EXPECT_LT(pixelDistance(kRadtan, *camera).rms, 0.5);
  EXPECT_FALSE(choice.settled());
  // Confirmed by the next comparison, not before it is due.
  EXPECT_FALSE(choice.consider(41, segments, *camera, 1));
  EXPECT_FALSE(choice.settled());
  EXPECT_FALSE(choice.consider(45, segments, *camera, 1));
  EXPECT_TRUE(choice.settled());
  EXPECT_NE(choice.sentence().find("lens model radtan"), std::string::npos) << choice.sentence();
  ASSERT_EQ(choice.evidence().size(), 5u);
  for (const ModelEvidence& evidence : choice.evidence()) {
    EXPECT_EQ(evidence.chosen, evidence.model == "radtan");
    if (evidence.model == "pinhole") {
      EXPECT_GT(evidence.behind, 100.0);
    }
  }
}

TEST(ModelChoice, PrefersTheSimplestThatFits) {
  for (const CameraModel present : {CameraModel::kRadtan, CameraModel::kEquidistant}) {
    ModelChoice choice{ModelChoiceOptions()};
    const auto camera =
        choice.consider(40, separateSegments(kPinhole, 4), as(present, kPinhole), 1);
    ASSERT_TRUE(camera) << toString(present);
    EXPECT_EQ(camera->model(), CameraModel::kPinhole);
  }
}

TEST(ModelChoice, DoesNotSwitchWithoutDecisiveEvidence) {
  ModelChoiceOptions options;
  options.decisive = 1e9;
  ModelChoice choice(options);
  const Camera fov = as(CameraModel::kFov, kRadtan);
  EXPECT_FALSE(choice.consider(40, separateSegments(kRadtan, 3), fov, 1));
  EXPECT_TRUE(choice.settled());
  // Neither does it hide that another is ahead.
  EXPECT_NE(choice.sentence().find("behind"), std::string::npos) << choice.sentence();
}

TEST(ModelChoice, NeedsSegmentsThatShareNothing) {
  ModelChoice choice{ModelChoiceOptions()};
  const std::vector<Segment> segments = separateSegments(kPinhole, 2);
  choice.observe(segments[0]);
  choice.observe(segments[0]);  // the same moments again
  EXPECT_FALSE(choice.consider(40, {}, kPinhole, 1));
  EXPECT_TRUE(choice.evidence().empty());
  EXPECT_EQ(choice.sentence(), "");
  choice.observe(segments[1]);
  EXPECT_FALSE(choice.consider(41, {}, kPinhole, 1));
  EXPECT_EQ(choice.evidence().size(), 5u);
  EXPECT_TRUE(choice.settled());
}

}  // namespace
}  // namespace camera_self_calibration
