#include "camera_self_calibration/ros/trail.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

Trail::Pose poseAt(std::int64_t stamp_ns) { return {stamp_ns, Rigid3()}; }

TEST(Trail, CoversAllTimesInBoundedMemory) {
  constexpr std::size_t kMax = 100;
  constexpr std::int64_t kPoses = 12345;
  Trail trail(kMax);
  for (std::int64_t i = 0; i < kPoses; ++i) {
    trail.add(poseAt(i), 0);
    ASSERT_LE(trail.poses().size(), kMax);
  }
  const auto& poses = trail.poses();
  ASSERT_GE(poses.size(), kMax / 2);
  EXPECT_EQ(poses.front().stamp_ns, 0);
  const std::int64_t step = poses[1].stamp_ns - poses[0].stamp_ns;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].stamp_ns - poses[i - 1].stamp_ns, step);
  }
  EXPECT_LT(kPoses - poses.back().stamp_ns, step + 1);
}

TEST(Trail, AnotherMapBeginsAnew) {
  Trail trail(10);
  for (std::int64_t i = 0; i < 25; ++i) trail.add(poseAt(i), 1);
  EXPECT_TRUE(trail.add(poseAt(100), 2));
  ASSERT_EQ(trail.poses().size(), 1u);
  EXPECT_TRUE(trail.add(poseAt(101), 2)) << "the stride must begin anew as well";
}

Trail::Pose poseAt(std::int64_t stamp_ns, double x) {
  return {stamp_ns, Rigid3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, 0.0, 0.0))};
}

// Lost at 10, a map of its own from 20 on, found again at 25.
TEST(Trail, AMapThatIsFoundAgainGoesOn) {
  Trail trail(100);
  for (std::int64_t i = 0; i < 10; ++i) trail.add(poseAt(i, 1.0 * i), 0);
  for (std::int64_t i = 20; i < 25; ++i) trail.add(poseAt(i, 0.0), 1);
  EXPECT_EQ(trail.poses().size(), 5u);
  const Similarity3 old_from_new{
      Rigid3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(7.0, 0.0, 0.0)), 2.0};
  trail.follow({1, 0, old_from_new});
  EXPECT_TRUE(trail.add(poseAt(25, 9.0), 0));
  ASSERT_EQ(trail.poses().size(), 16u);
  for (std::size_t i = 1; i < 16; ++i) {
    EXPECT_LT(trail.poses()[i - 1].stamp_ns, trail.poses()[i].stamp_ns);
  }
  EXPECT_EQ(trail.poses()[9].world_from_camera.translation.x(), 9.0);
  EXPECT_EQ(trail.poses()[10].world_from_camera.translation.x(), 7.0) << "of the map in between";
}

TEST(Trail, IsScaledWithItsMap) {
  Trail trail(100);
  for (std::int64_t i = 0; i < 10; ++i) trail.add(poseAt(i, 1.0 * i), 3);
  trail.follow({3, 4, Similarity3{Rigid3(), 0.5}});
  ASSERT_EQ(trail.poses().size(), 10u);
  EXPECT_EQ(trail.poses()[8].world_from_camera.translation.x(), 4.0);
  trail.follow({77, 4, Similarity3()});  // not known: nothing happens
  EXPECT_EQ(trail.poses().size(), 10u);
}

TEST(Trail, IsBoundedWhateverTheNumberOfMaps) {
  Trail trail(100);
  for (std::int64_t i = 0; i < 50; ++i) trail.add(poseAt(i), 0);
  for (std::uint64_t map = 1; map < 500; ++map) {
    for (std::int64_t i = 0; i < 5; ++i) trail.add(poseAt(100 + i), map);
  }
  trail.add(poseAt(1000), 0);
  EXPECT_EQ(trail.poses().size(), 51u) << "the longest is not the one that is forgotten";
  trail.add(poseAt(1001), 1);
  EXPECT_EQ(trail.poses().size(), 1u) << "forgotten meanwhile";
}

}  // namespace
}  // namespace camera_self_calibration
