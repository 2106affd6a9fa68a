#include "camera_self_calibration/estimation/robust.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

TEST(Huber, IsQuadraticThenLinear) {
  EXPECT_DOUBLE_EQ(huberCost(1.5, 2.0), 1.125);
  EXPECT_DOUBLE_EQ(huberCost(5.0, 2.0), 2.0 * 5.0 - 2.0);
  EXPECT_DOUBLE_EQ(huberCost(5.0, 0.0), 12.5);
  EXPECT_DOUBLE_EQ(huberCost(5.0, -1.0), 12.5);
  EXPECT_DOUBLE_EQ(huberWeight(1.5, 2.0), 1.0);
  EXPECT_DOUBLE_EQ(huberWeight(5.0, 2.0), 0.4);
  EXPECT_DOUBLE_EQ(huberWeight(5.0, 0.0), 1.0);
}

TEST(Huber, IsContinuousWithItsDerivative) {
  constexpr double kStep = 1e-6;
  EXPECT_NEAR(huberCost(2.0 - kStep, 2.0), huberCost(2.0 + kStep, 2.0), 5e-6);
  for (const double norm : {0.5, 1.999, 2.001, 7.0}) {
    const double slope =
        (huberCost(norm + kStep, 2.0) - huberCost(norm - kStep, 2.0)) / (2.0 * kStep);
    EXPECT_NEAR(slope, huberWeight(norm, 2.0) * norm, 1e-8);  // the weight's definition
  }
}

}  // namespace
}  // namespace camera_self_calibration
