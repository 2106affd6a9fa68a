#include "camera_self_calibration/estimation/pose_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "camera_self_calibration/geometry/so3.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

// Points 2 to 6 units ahead of a camera at `pose`, referred to another camera's position.
std::vector<PointView> viewsFrom(const Camera& camera, const Rigid3& pose, int count, double sigma,
                                 Random* random) {
  const Eigen::Vector3d origin(0.3, -0.2, 0.1);
  std::vector<PointView> views;
  while (static_cast<int>(views.size()) < count) {
    const Eigen::Vector2d pixel(random->uniform(20, 620), random->uniform(20, 460));
    const auto ray = camera.unproject(pixel);
    if (!ray) continue;
    const Eigen::Vector3d point = pose * (random->uniform(2.0, 6.0) * *ray);
    const Eigen::Vector3d offset = point - origin;
    views.push_back({{offset.normalized(), origin, 1.0 / offset.norm()},
                     pixel + sigma * random->normal2(),
                     std::max(sigma, 0.1)});
  }
  return views;
}

Vector6d errorOf(const Rigid3& estimate, const Rigid3& truth) {
  Vector6d error;
  error << estimate.translation - truth.translation,
      logSo3(truth.rotation.conjugate() * estimate.rotation);
  return error;
}

const Rigid3 kPose{expSo3({0.1, -0.2, 0.3}), Eigen::Vector3d(0.5, 0.1, -0.4)};
const Rigid3 kGuess{expSo3({0.05, -0.1, 0.25}), Eigen::Vector3d(0.4, 0.15, -0.3)};

TEST(SolvePose, FindsTheTruthWithoutNoise) {
  for (const Camera& camera : ordinaryCameras()) {
    Random random(1);
    const auto views = viewsFrom(camera, kPose, 40, 0.0, &random);
    const PoseEstimate estimate = solvePose(camera, views, kGuess);
    ASSERT_TRUE(estimate.usable);
    EXPECT_LT(errorOf(estimate.world_from_camera, kPose).norm(), 1e-5);
    EXPECT_EQ(estimate.inliers, 40);
    EXPECT_EQ(estimate.residual_scale, 1.0);
  }
}

TEST(SolvePose, CovarianceIsThatOfItsErrors) {
  const Camera camera = ordinaryCameras()[1];
  constexpr int kTrials = 200;
  double sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Random random(100 + trial);
    const PoseEstimate estimate =
        solvePose(camera, viewsFrom(camera, kPose, 60, 0.4, &random), kGuess);
    ASSERT_TRUE(estimate.usable);
    const Vector6d error = errorOf(estimate.world_from_camera, kPose);
    sum += error.dot(estimate.covariance.ldlt().solve(error)) / kTrials;
  }
  // Chi-square with 6 degrees; the scale, which is at least 1, makes the covariance a little large.
  EXPECT_GT(sum, 4.5);
  EXPECT_LT(sum, 6.6);
}

TEST(SolvePose, BearsOutliers) {
  const Camera camera = ordinaryCameras()[3];
  Random random(2);
  auto views = viewsFrom(camera, kPose, 60, 0.3, &random);
  for (int i = 0; i < 12; ++i) views[5 * i].pixel += Eigen::Vector2d(40.0, -30.0);
  const PoseEstimate estimate = solvePose(camera, views, kGuess, 2.0, 30);
  ASSERT_TRUE(estimate.usable);
  EXPECT_LT(errorOf(estimate.world_from_camera, kPose).norm(), 0.02);
  EXPECT_GE(estimate.inliers, 46);
  EXPECT_LE(estimate.inliers, 48);
}

TEST(SolvePose, SaysWhatItCannotDo) {
  const Camera camera = ordinaryCameras()[0];
  Random random(3);
  EXPECT_FALSE(solvePose(camera, {}, kGuess).usable);
  EXPECT_FALSE(solvePose(camera, viewsFrom(camera, kPose, 2, 0.3, &random), kGuess).usable);
  // Without depth nothing tells the translation.
  auto far = viewsFrom(camera, kPose, 30, 0.0, &random);
  for (PointView& view : far) view.inverse_depth = 0.0;
  const PoseEstimate estimate = solvePose(camera, far, kGuess);
  EXPECT_FALSE(estimate.usable);
  EXPECT_TRUE(estimate.world_from_camera.translation.allFinite());
  // Everything behind the camera.
  auto behind = viewsFrom(camera, kPose, 30, 0.0, &random);
  for (PointView& view : behind) view.direction *= -1.0;
  EXPECT_FALSE(solvePose(camera, behind, kGuess).usable);
}

TEST(SolvePose, RefusesAPoseThatMostViewsLieBehind) {
  const Camera camera = ordinaryCameras()[0];
  Random random(4);
  auto views = viewsFrom(camera, kPose, 60, 0.3, &random);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (i % 5 < 3) views[i].direction *= -1.0;
    if (i % 5 < 3) views[i].inverse_depth = 0.0;
  }
  const PoseEstimate estimate = solvePose(camera, views, kPose);
  EXPECT_FALSE(estimate.usable);
  EXPECT_LE(estimate.inliers, 24);
}

}  // namespace
}  // namespace camera_self_calibration
