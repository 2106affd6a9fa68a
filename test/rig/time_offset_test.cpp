#include "camera_self_calibration/rig/time_offset.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"

namespace camera_self_calibration {
namespace {

std::vector<RotationPair> turning(MotionKind kind, double offset_s, double noise_rad) {
  SyntheticMotionOptions options;
  options.kind = kind;
  options.duration_s = 20.0;
  const Trajectory way = syntheticMotion(options);
  const Eigen::Quaterniond rig_from_camera = expSo3({0.2, 1.0, -0.3});
  Random random(7);
  std::vector<RotationPair> pairs;
  for (int i = 0; i < 300; ++i) {
    const double time = 1.0 + 0.05 * i;
    RotationPair pair;
    pair.stamp_ns = std::llround(1e9 * time);
    pair.world_from_rig = way.worldFromCamera(time).rotation * expSo3(noise_rad * random.normal3());
    pair.world_from_camera = way.worldFromCamera(time + offset_s).rotation * rig_from_camera *
                             expSo3(noise_rad * random.normal3());
    pairs.push_back(pair);
  }
  return pairs;
}

TEST(TimeOffset, IsFoundWithinAMillisecond) {
  for (const double offset : {-0.007, 0.003, 0.02}) {
    const TimeOffset found = timeOffset(turning(MotionKind::kHandheld, offset, 0.0005));
    EXPECT_NEAR(found.seconds, offset, 1e-3);
    EXPECT_LT(std::abs(found.seconds - offset), 4.0 * found.sigma);
    EXPECT_TRUE(found.harms());
  }
}

TEST(TimeOffset, NoneIsNone) {
  const TimeOffset found = timeOffset(turning(MotionKind::kHandheld, 0.0, 0.0005));
  EXPECT_LT(std::abs(found.seconds), 4.0 * found.sigma);
  EXPECT_FALSE(found.harms());
}

TEST(TimeOffset, WithoutRotationNothingIsKnown) {
  EXPECT_FALSE(timeOffset(turning(MotionKind::kSidewaysOnly, 0.01, 0.0005)).harms());
  EXPECT_TRUE(std::isinf(timeOffset({}).sigma));
}

TEST(TimeOffset, MapsThatBeginAnewDoNoHarm) {
  std::vector<RotationPair> pairs = turning(MotionKind::kHandheld, 0.007, 0.0005);
  for (std::size_t i = 150; i < pairs.size(); ++i) {
    pairs[i].camera_map = 1;
    pairs[i].world_from_camera = expSo3({1.0, 2.0, 0.5}) * pairs[i].world_from_camera;
  }
  EXPECT_NEAR(timeOffset(pairs).seconds, 0.007, 1e-3);
}

}  // namespace
}  // namespace camera_self_calibration
