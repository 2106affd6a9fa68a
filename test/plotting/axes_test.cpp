#include "camera_self_calibration/plotting/axes.h"

#include <gtest/gtest.h>

#include <limits>

namespace camera_self_calibration {
namespace {

TEST(Axes, TicksAreRoundAndInside) {
  EXPECT_EQ(roundTicks({0.0, 10.0}, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  const auto ticks = roundTicks({310.93, 311.41}, 4);
  ASSERT_EQ(ticks.size(), 5u);
  EXPECT_NEAR(ticks.front(), 311.0, 1e-9);
  EXPECT_EQ(tickText(ticks.front(), ticks[1] - ticks[0]), "311.0");
}

TEST(Axes, ARangeWithoutWidthHasNoTicks) {
  EXPECT_TRUE(roundTicks({3.0, 3.0}, 5).empty());
  EXPECT_TRUE(roundTicks({0.0, std::numeric_limits<double>::infinity()}, 5).empty());
}

TEST(Axes, YGrowsUpwards) {
  const Axes axes = {{100.0, 50.0, 200.0, 100.0}, {0.0, 10.0}, {-1.0, 1.0}, false};
  EXPECT_EQ(axes.at(0.0, -1.0), cv::Point2d(100.0, 150.0));
  EXPECT_EQ(axes.at(10.0, 1.0), cv::Point2d(300.0, 50.0));
}

TEST(Axes, LogarithmicAxesPutEqualFactorsAtEqualDistances) {
  const Axes axes = {{0.0, 0.0, 10.0, 90.0}, {0.0, 1.0}, {0.01, 10.0}, true};
  EXPECT_NEAR(axes.at(0.0, 0.1).y, 60.0, 1e-9);
  EXPECT_NEAR(axes.at(0.0, 1.0).y, 30.0, 1e-9);
}

}  // namespace
}  // namespace camera_self_calibration
