#include "camera_self_calibration/base/noisy_length.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

NoisyLength lengthOf(const Eigen::Vector3d& vector, const Eigen::Matrix3d& covariance) {
  return {vector.squaredNorm(), covariance.trace(),
          4.0 * vector.dot(covariance * vector) + 2.0 * (covariance * covariance).trace()};
}

// Over vectors that scatter as their covariance says, from those that are lost in it to those far
// beyond it.
TEST(NoisyLength, TheBoundHolds) {
  Random random(11);
  const Eigen::Vector3d sigmas(1.0, 0.5, 0.1);
  const Eigen::Matrix3d covariance = sigmas.cwiseAbs2().asDiagonal();
  for (const double truth : {0.0, 0.3, 1.0, 3.0, 20.0}) {
    int beyond = 0;
    constexpr int kDraws = 4000;
    for (int i = 0; i < kDraws; ++i) {
      const Eigen::Vector3d direction = random.normal3().normalized();
      const Eigen::Vector3d seen = truth * direction + sigmas.cwiseProduct(random.normal3());
      beyond += truth > lengthOf(seen, covariance).atMost();
    }
    EXPECT_LE(beyond, kDraws / 100) << truth;
  }
}

TEST(NoisyLength, FarBeyondTheNoiseItIsNormal) {
  const NoisyLength length = lengthOf({100.0, 0.0, 0.0}, Eigen::Matrix3d::Identity());
  EXPECT_NEAR(length.length(), 100.0, 0.02);
  EXPECT_NEAR(length.sigma(), 1.0, 0.02);
  EXPECT_NEAR(length.atMost(), 103.0, 0.1);
}

TEST(NoisyLength, WhatIsLostInTheNoiseMayBeAsLongAsThat) {
  const NoisyLength length = lengthOf(Eigen::Vector3d::Zero(), 4.0 * Eigen::Matrix3d::Identity());
  EXPECT_EQ(length.length(), 0.0);
  EXPECT_GT(length.atMost(), 2.0);
}

TEST(NoisyLength, OtherErrorsAdd) {
  NoisyLength length = lengthOf({1.0, 0.0, 0.0}, 1e-12 * Eigen::Matrix3d::Identity());
  length.other_sigma = 0.5;
  EXPECT_NEAR(length.sigma(), 0.5, 1e-6);
  EXPECT_NEAR(length.atMost(), 2.5, 1e-3);
}

TEST(NoisyLength, NothingIsKnownAtFirst) {
  EXPECT_FALSE(std::isfinite(NoisyLength().length()));
  EXPECT_FALSE(std::isfinite(NoisyLength().atMost()));
}

}  // namespace
}  // namespace camera_self_calibration
