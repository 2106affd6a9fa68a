#include "camera_self_calibration/reference/trajectory_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

using Poses = std::vector<StampedCameraPose>;

/// Along a bent and twisted way, at 20 Hz.
Poses someWay(int count, std::int64_t interval_ns = 50000000) {
  Poses poses;
  for (int i = 0; i < count; ++i) {
    const double t = toSeconds(interval_ns * i);
    StampedCameraPose pose;
    pose.stamp_ns = 1000000000 + interval_ns * i;
    pose.world_from_camera.translation << 2.0 * std::cos(0.4 * t), 2.0 * std::sin(0.4 * t),
        0.3 * std::sin(1.3 * t);
    pose.world_from_camera.rotation = expSo3({0.2 * std::sin(t), 0.4 * t, 0.1});
    poses.push_back(pose);
  }
  return poses;
}

Poses moved(Poses poses, const Rigid3& motion, double scale) {
  for (StampedCameraPose& pose : poses) {
    pose.world_from_camera.translation *= scale;
    pose.world_from_camera = motion * pose.world_from_camera;
  }
  return poses;
}

/// Turns about z by so many radians a second.
Poses drifting(Poses poses, double rate) {
  for (StampedCameraPose& pose : poses) {
    const double t = toSeconds(pose.stamp_ns);
    pose.world_from_camera.rotation = expSo3({0, 0, rate * t}) * pose.world_from_camera.rotation;
  }
  return poses;
}

const Rigid3 kMotion(expSo3({0.4, -1.0, 0.7}), {5.0, -3.0, 1.0});

TEST(TrajectoryComparison, ASimilarityMakesNoDifference) {
  const Poses way = someWay(300);
  const auto difference = compareTrajectories(moved(way, kMotion, 0.25), way);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->poses, 300);
  EXPECT_NEAR(difference->scale, 4.0, 1e-9);
  EXPECT_LT(difference->rms, 1e-9);
  EXPECT_LT(difference->relative_translation, 1e-9);
  EXPECT_LT(difference->relative_rotation_deg, 1e-5);
  EXPECT_NEAR(difference->travelled, 13.0, 0.5);  // about 0.87 m/s for 15 s
  const Poses aligned = alignedTo(way, moved(way, kMotion, 0.25));
  ASSERT_EQ(aligned.size(), way.size());
  EXPECT_LT(
      (aligned[77].world_from_camera.translation - way[77].world_from_camera.translation).norm(),
      1e-9);
}

TEST(TrajectoryComparison, TellsAKnownErrorAndItsShareOfTheWay) {
  const Poses way = someWay(400);
  Poses wrong = way;
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    wrong[i].world_from_camera.translation.z() += i % 2 == 0 ? 0.1 : -0.1;
  }
  const auto difference = compareTrajectories(wrong, way);
  ASSERT_TRUE(difference);
  EXPECT_NEAR(difference->mean, 0.1, 1e-3);
  EXPECT_NEAR(difference->rms, 0.1, 1e-3);
  EXPECT_NEAR(difference->share(), 0.1 / difference->travelled, 1e-4);
  // 1 s is 20 frames: both ends are off alike.
  EXPECT_NEAR(difference->relative_translation, 0.0, 5e-3);
}

TEST(TrajectoryComparison, RelativeErrorIsThatOfOneSecond) {
  const Poses way = someWay(400);
  const auto difference = compareTrajectories(drifting(way, 0.5 * kDegree), way);
  ASSERT_TRUE(difference);
  EXPECT_LT(difference->rms, 1e-9);
  EXPECT_NEAR(difference->relative_rotation_deg, 0.5, 0.01);
}

TEST(TrajectoryComparison, RelativeErrorIsOfThePosesNearestToOneSecondApart) {
  const Poses way = someWay(100, 133333333);
  const auto difference = compareTrajectories(drifting(way, 0.5 * kDegree), way);
  ASSERT_TRUE(difference);
  EXPECT_NEAR(difference->relative_rotation_deg, 0.5 * 8 * 0.1333, 0.01);
}

TEST(TrajectoryComparison, WithoutPosesOneSecondApartThereIsNoRelativeError) {
  const Poses way = someWay(15);
  const auto difference = compareTrajectories(way, way);
  ASSERT_TRUE(difference);
  EXPECT_TRUE(std::isnan(difference->relative_translation));
  EXPECT_TRUE(std::isnan(difference->relative_rotation_deg));
}

TEST(TrajectoryComparison, EachMapIsAlignedByItself) {
  const Poses way = someWay(400);
  Poses two_maps = moved(way, kMotion, 0.5);
  for (std::size_t i = 200; i < two_maps.size(); ++i) {
    two_maps[i] = moved(way, kMotion.inverse(), 3.0)[i];
    two_maps[i].map_id = 1;
  }
  const auto difference = compareTrajectories(two_maps, way);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->poses, 400);
  EXPECT_LT(difference->rms, 1e-9);
}

TEST(TrajectoryComparison, TheReferenceIsInterpolatedButNotOverGaps) {
  const Poses way = someWay(400);
  Poses sparse;
  for (std::size_t i = 0; i < way.size(); i += 4) sparse.push_back(way[i]);
  const auto difference = compareTrajectories(way, sparse);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->poses, 397);  // not beyond the last
  EXPECT_LT(difference->max, 0.02);
  sparse.erase(sparse.begin() + 10, sparse.begin() + 20);
  EXPECT_EQ(compareTrajectories(way, sparse)->poses, 397 - 43);
}

TEST(TrajectoryComparison, WithoutCommonTimesThereIsNothing) {
  const Poses way = someWay(50);
  EXPECT_FALSE(compareTrajectories(way, {}));
  EXPECT_FALSE(compareTrajectories({}, way));
  EXPECT_FALSE(compareTrajectories(between(way, 0, 1), way));
  Poses later = way;
  for (StampedCameraPose& pose : later) pose.stamp_ns += 1000000000000;
  EXPECT_FALSE(compareTrajectories(later, way));
}

TEST(TrajectoryComparison, ATurnOnTheSpotHasNoScale) {
  Poses turning = someWay(100);
  for (StampedCameraPose& pose : turning) pose.world_from_camera.translation.setZero();
  const auto difference = compareTrajectories(turning, turning);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->scale, 1.0);
  EXPECT_EQ(difference->share(), 0.0);
}

}  // namespace
}  // namespace camera_self_calibration
