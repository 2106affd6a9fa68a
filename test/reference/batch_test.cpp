#include "camera_self_calibration/reference/batch.h"

#include <gtest/gtest.h>

#include <functional>

#include "camera/sample_cameras.h"
#include "reference/batch_scene.h"

namespace camera_self_calibration {
namespace {

const Camera kFov = camera640(CameraModel::kFov, {320, 322, 316, 243, 0.95});

Camera startOf(const Camera& truth) {
  Camera start = truth;
  Intrinsics parameters = truth.parameters();
  parameters.head<4>() += Eigen::Vector4d(12, -10, 6, -8);
  if (truth.model() == CameraModel::kFov) parameters[4] += 0.05;
  if (truth.model() == CameraModel::kRadtan) parameters[4] += 0.02;
  start.setParameters(parameters);
  return start;
}

BatchSegment gaugeFixed(const BatchScene& scene, Segment* segment) {
  return {segment, 1, scene.scaleLandmark(), 1.0};
}

void expectSameState(const Segment& a, const Segment& b, double tolerance) {
  for (std::size_t k = 0; k < a.keyframes.size(); ++k) {
    const Rigid3 difference =
        a.keyframes[k].world_from_camera.inverse() * b.keyframes[k].world_from_camera;
    EXPECT_LT(logSe3(difference).norm(), tolerance) << "keyframe " << k;
  }
  for (std::size_t i = 0; i < a.landmarks.size(); ++i) {
    EXPECT_NEAR(a.landmarks[i].inverse_depth, b.landmarks[i].inverse_depth, tolerance);
    EXPECT_LT((a.landmarks[i].bearing - b.landmarks[i].bearing).norm(), tolerance);
    EXPECT_NEAR(b.landmarks[i].bearing.norm(), 1.0, 1e-12);
  }
}

TEST(Batch, RecoversTheTruthOfEveryModel) {
  for (const Camera& camera :
       {kFov, camera640(CameraModel::kPinhole, {330, 325, 322, 238}),
        camera640(CameraModel::kRadtan, {400, 405, 322, 238, -0.2, 0.05, 1e-3, -1e-3}),
        camera640(CameraModel::kEquidistant, {290, 285, 322, 238, 0.01, -0.01, 0.002, -1e-3})}) {
    SCOPED_TRACE(describe(camera));
    const BatchScene scene(camera, 8, 60, 5);
    Segment segment = scene.truth();
    disturb(&segment, scene.scaleLandmark(), 0.02, 11);
    Camera estimate = startOf(camera);
    const BatchSummary summary = solveBatch({gaugeFixed(scene, &segment)}, &estimate, {});
    EXPECT_TRUE(summary.converged) << summary.message;
    EXPECT_GT(summary.initial_cost, 1e3);
    EXPECT_LT(summary.final_cost, 1e-12);
    EXPECT_LT((estimate.parameters() - camera.parameters()).norm(), 1e-6);
    expectSameState(scene.truth(), segment, 1e-6);
  }
}

TEST(Batch, SeveralSegmentsShareTheCamera) {
  const BatchScene first(kFov, 6, 40, 1), second(kFov, 7, 40, 2);
  Segment a = first.truth(), b = second.truth();
  disturb(&a, first.scaleLandmark(), 0.02, 3);
  disturb(&b, second.scaleLandmark(), 0.02, 4);
  Camera estimate = startOf(kFov);
  BatchOptions options;
  options.threads = 2;
  const BatchSummary summary =
      solveBatch({gaugeFixed(first, &a), gaugeFixed(second, &b)}, &estimate, options);
  EXPECT_TRUE(summary.converged) << summary.message;
  EXPECT_LT((estimate.parameters() - kFov.parameters()).norm(), 1e-6);
  expectSameState(first.truth(), a, 1e-6);
  expectSameState(second.truth(), b, 1e-6);
}

TEST(Batch, TheGaugeStaysWhereItIs) {
  const BatchScene scene(kFov, 8, 40, 5);
  Segment segment = scene.noisy(0.5, 9);
  disturb(&segment, -1, 0.02, 11);
  const Segment before = segment;
  Camera estimate = startOf(kFov);
  solveBatch({{&segment, 3, 7, 1.0}}, &estimate, {});
  for (int k = 0; k < 8; ++k) {
    const Rigid3& old_pose = before.keyframes[k].world_from_camera;
    const Rigid3& new_pose = segment.keyframes[k].world_from_camera;
    EXPECT_EQ(old_pose.translation == new_pose.translation, k < 3) << k;
    EXPECT_EQ(old_pose.rotation.coeffs() == new_pose.rotation.coeffs(), k < 3) << k;
  }
  EXPECT_EQ(before.landmarks[7].inverse_depth, segment.landmarks[7].inverse_depth);
  EXPECT_NE(before.landmarks[6].inverse_depth, segment.landmarks[6].inverse_depth);
}

TEST(Batch, HoldsTheIntrinsicsOnDemand) {
  const BatchScene scene(kFov, 8, 40, 5);
  Segment segment = scene.noisy(0.5, 9);
  Camera camera = startOf(kFov);
  const Camera before = camera;
  BatchOptions options;
  options.estimate_intrinsics = false;
  const BatchSummary summary = solveBatch({gaugeFixed(scene, &segment)}, &camera, options);
  EXPECT_TRUE(summary.converged);
  EXPECT_LT(summary.final_cost, summary.initial_cost);
  EXPECT_EQ(camera.parameters(), before.parameters());
}

TEST(Batch, HoldsK3UnlessItIsEstimated) {
  Camera truth(CameraModel::kRadtan, 640, 480,
               intrinsics({400, 405, 322, 238, -0.2, 0.05, 1e-3, -1e-3, -0.01}));
  const BatchScene scene(truth, 8, 60, 5);
  for (const bool estimated : {false, true}) {
    Segment segment = scene.truth();
    Camera camera = truth;
    Intrinsics parameters = truth.parameters();
    parameters[8] = -0.012;
    camera.setParameters(parameters);
    camera.setEstimateK3(estimated);
    const BatchSummary summary = solveBatch({gaugeFixed(scene, &segment)}, &camera, {});
    EXPECT_TRUE(summary.converged);
    if (estimated) {
      EXPECT_NEAR(camera.parameters()[8], -0.01, 1e-6);
      EXPECT_LT(summary.final_cost, 1e-12);
    } else {
      EXPECT_EQ(camera.parameters()[8], -0.012);
      EXPECT_GT(summary.final_cost, 1e-9);
    }
  }
}

TEST(Batch, HuberLimitsTheHarmOfOutliers) {
  const BatchScene scene(kFov, 8, 60, 5);
  const auto errorWith = [&](double huber) {
    Segment segment = scene.noisy(0.3, 21);
    for (std::size_t i = 7; i < segment.observations.size(); i += 40) {
      segment.observations[i].pixel += Eigen::Vector2d(25, -18);
    }
    Camera estimate = kFov;
    BatchOptions options;
    options.huber = huber;
    EXPECT_TRUE(solveBatch({gaugeFixed(scene, &segment)}, &estimate, options).converged);
    return (estimate.parameters() - kFov.parameters()).head<4>().norm();
  };
  const double plain = errorWith(0.0), robust = errorWith(1.5);
  EXPECT_GT(plain, 3.0);
  EXPECT_LT(robust, 0.25 * plain);
}

TEST(Batch, SigmaScaleScalesTheCost) {
  const BatchScene scene(kFov, 8, 40, 5);
  Segment once = scene.noisy(0.5, 9), twice = once;
  Camera a = kFov, b = kFov;
  BatchSegment scaled = gaugeFixed(scene, &twice);
  scaled.sigma_scale = 2.0;
  const BatchSummary plain = solveBatch({gaugeFixed(scene, &once)}, &a, {});
  const BatchSummary wide = solveBatch({scaled}, &b, {});
  EXPECT_NEAR(wide.initial_cost / plain.initial_cost, 0.25, 1e-12);
  EXPECT_NEAR(wide.final_cost / plain.final_cost, 0.25, 1e-9);
  EXPECT_LT((a.parameters() - b.parameters()).norm(), 1e-5);
}

// The noise leaves as much cost as there are more measurements than parameters.
TEST(Batch, TheCostIsThatOfTheNoise) {
  const BatchScene scene(kFov, 8, 60, 5);
  Segment segment = scene.noisy(0.5, 9);
  Camera estimate = kFov;
  const BatchSummary summary = solveBatch({gaugeFixed(scene, &segment)}, &estimate, {});
  ASSERT_TRUE(summary.converged);
  const double measurements = 2.0 * segment.observations.size();
  const double freedom = measurements - (7 * 6 + 60 + 2 * 20 - 1 + 5);
  EXPECT_NEAR(2.0 * summary.final_cost / freedom, 1.0, 4.0 * std::sqrt(2.0 / freedom));
}

TEST(Batch, APointOutsideTheDomainDoesNotStopIt) {
  const BatchScene scene(kFov, 8, 60, 5);
  Segment segment = scene.truth();
  segment.landmarks[3].reference_pixel << 5000, 5000;
  Camera estimate = startOf(kFov);
  const BatchSummary summary = solveBatch({gaugeFixed(scene, &segment)}, &estimate, {});
  EXPECT_TRUE(summary.converged);
  EXPECT_LT((estimate.parameters() - kFov.parameters()).norm(), 1e-6);
}

TEST(Batch, MalformedInputIsNamedAndChangesNothing) {
  const BatchScene scene(kFov, 8, 40, 5);
  const auto messageAfter = [&](const std::function<void(Segment*, BatchSegment*)>& spoil) {
    Segment segment = scene.noisy(0.5, 9);
    BatchSegment batch = gaugeFixed(scene, &segment);
    spoil(&segment, &batch);
    const Segment before = segment;
    Camera camera = startOf(kFov);
    const BatchSummary summary = solveBatch({batch}, &camera, {});
    EXPECT_FALSE(summary.converged);
    EXPECT_EQ(camera.parameters(), startOf(kFov).parameters());
    EXPECT_EQ(segment.keyframes[4].world_from_camera.translation,
              before.keyframes[4].world_from_camera.translation);
    EXPECT_FALSE(batchCovariance({batch}, camera, {}));
    return summary.message;
  };
  const auto names = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  names(messageAfter([](Segment* s, BatchSegment*) { s->observations[5].landmark = 40; }),
        "observation 5 refers to a landmark that does not exist");
  names(messageAfter([](Segment* s, BatchSegment*) { s->observations[5].keyframe = -1; }),
        "observation 5 refers to a keyframe that does not exist");
  names(messageAfter([](Segment* s, BatchSegment*) { s->observations[6].sigma = 0.0; }),
        "observation 6 has a sigma that is not positive");
  names(messageAfter([](Segment* s, BatchSegment*) { s->observations[0].keyframe = 0; }),
        "observation 0 lies in the reference keyframe");
  names(messageAfter([](Segment* s, BatchSegment*) { s->landmarks[2].bearing *= 2.0; }),
        "landmark 2 has a bearing that is not unit");
  names(messageAfter([](Segment* s, BatchSegment*) { s->landmarks[3].reference = 8; }),
        "landmark 3 refers to a keyframe");
  names(messageAfter([](Segment*, BatchSegment* b) { b->fixed_landmark = 40; }),
        "fixes a landmark that does not exist");
  names(messageAfter([](Segment*, BatchSegment* b) { b->sigma_scale = -1.0; }), "sigma_scale");
  names(messageAfter([](Segment*, BatchSegment* b) { b->segment = nullptr; }), "null pointer");
  names(messageAfter([](Segment* s, BatchSegment*) { s->observations.clear(); }),
        "no observations");
  names(messageAfter([](Segment* s, BatchSegment*) {
          s->keyframes[2].world_from_camera.rotation.coeffs() *= 1.1;
        }),
        "keyframe 2 has a quaternion that is not unit");
}

TEST(Batch, RefusesACameraThatIsNotValid) {
  const BatchScene scene(kFov, 8, 40, 5);
  Segment segment = scene.truth();
  Camera camera;
  const BatchSummary summary = solveBatch({gaugeFixed(scene, &segment)}, &camera, {});
  EXPECT_FALSE(summary.converged);
  EXPECT_NE(summary.message.find("not valid"), std::string::npos);
}

}  // namespace
}  // namespace camera_self_calibration
