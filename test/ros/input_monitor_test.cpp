#include "camera_self_calibration/ros/input_monitor.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

GrayImage image(double seconds, int width = 64, int height = 48) {
  ImageView view;
  view.width = width;
  view.height = height;
  view.stamp_ns = static_cast<std::int64_t>(seconds * 1e9);
  return {view, {}};
}

TEST(InputMonitor, TakesGrowingStamps) {
  InputMonitor monitor;
  EXPECT_EQ(monitor.check(image(10.0)), InputVerdict::kUse);
  EXPECT_EQ(monitor.check(image(10.1)), InputVerdict::kUse);
  EXPECT_EQ(monitor.check(image(500.0)), InputVerdict::kUse);
  EXPECT_EQ(monitor.counts().used, 3);
  EXPECT_EQ(monitor.counts().rejected, 0);
  EXPECT_EQ(monitor.width(), 64);
  EXPECT_EQ(monitor.height(), 48);
}

TEST(InputMonitor, RejectsDuplicatesAndLateImages) {
  InputMonitor monitor;
  monitor.check(image(10.0));
  monitor.check(image(10.1));
  EXPECT_EQ(monitor.check(image(10.1)), InputVerdict::kReject);
  EXPECT_EQ(monitor.check(image(10.05)), InputVerdict::kReject);
  EXPECT_EQ(monitor.check(image(10.2)), InputVerdict::kUse);
  EXPECT_EQ(monitor.counts().rejected, 2);
}

TEST(InputMonitor, AClockThatJumpsBackRestartsOnce) {
  InputMonitor monitor;
  monitor.check(image(100.0));
  EXPECT_EQ(monitor.check(image(10.0)), InputVerdict::kRestart);
  EXPECT_NE(monitor.counts().last_problem.find("90.0"), std::string::npos);
  EXPECT_EQ(monitor.check(image(10.1)), InputVerdict::kUse);
  EXPECT_EQ(monitor.counts().jumps, 1);
}

TEST(InputMonitor, RejectsAnotherSizeAndReturns) {
  InputMonitor monitor;
  monitor.check(image(10.0));
  EXPECT_EQ(monitor.check(image(10.1, 32, 24)), InputVerdict::kReject);
  EXPECT_NE(monitor.counts().last_problem.find("64x48 to 32x24"), std::string::npos);
  EXPECT_EQ(monitor.check(image(10.2)), InputVerdict::kUse);
}

TEST(InputMonitor, PassesOnWhyAnImageCannotBeRead) {
  InputMonitor monitor;
  EXPECT_EQ(monitor.check({std::nullopt, "the image is empty"}), InputVerdict::kReject);
  EXPECT_EQ(monitor.counts().last_problem, "the image is empty");
  EXPECT_EQ(monitor.check(image(1.0)), InputVerdict::kUse);
}

}  // namespace
}  // namespace camera_self_calibration
