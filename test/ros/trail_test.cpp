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

}  // namespace
}  // namespace camera_self_calibration
