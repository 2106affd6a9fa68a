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

TEST(InputMonitor, ASingleImageOfAnotherSizeChangesNothing) {
  InputMonitor monitor;
  monitor.check(image(10.0));
  EXPECT_EQ(monitor.check(image(10.1, 32, 24)), InputVerdict::kReject);
  EXPECT_NE(monitor.counts().last_problem.find("64 x 48 to 32 x 24"), std::string::npos);
  EXPECT_EQ(monitor.check(image(10.2)), InputVerdict::kUse);
  // Two cameras on one topic: neither wins.
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(monitor.check(image(11.0 + 0.1 * i, 32, 24)), InputVerdict::kReject);
    EXPECT_EQ(monitor.check(image(11.05 + 0.1 * i)), InputVerdict::kUse);
  }
  EXPECT_EQ(monitor.counts().size_changes, 0);
}

TEST(InputMonitor, AnotherSizeThatStaysIsTaken) {
  InputMonitor monitor;
  monitor.check(image(10.0));
  for (int i = 1; i < InputMonitor::kSizePatience; ++i) {
    EXPECT_EQ(monitor.check(image(10.0 + 0.1 * i, 32, 24)), InputVerdict::kReject) << i;
    EXPECT_NE(monitor.counts().last_problem.find("the calibration goes over to the new size"),
              std::string::npos);
  }
  EXPECT_EQ(monitor.check(image(12.0, 32, 24)), InputVerdict::kNewSize);
  EXPECT_EQ(monitor.width(), 32);
  EXPECT_EQ(monitor.check(image(12.1, 32, 24)), InputVerdict::kUse);
  EXPECT_EQ(monitor.check(image(12.2)), InputVerdict::kReject);
  EXPECT_EQ(monitor.counts().size_changes, 1);
}

TEST(InputMonitor, AnotherSizeIsNotLostWithAnImageThatIsLate) {
  InputMonitor monitor;
  monitor.check(image(10.0));
  for (int i = 1; i < InputMonitor::kSizePatience; ++i) {
    monitor.check(image(10.0 + 0.1 * i, 32, 24));
  }
  EXPECT_EQ(monitor.check(image(9.9, 32, 24)), InputVerdict::kReject);
  EXPECT_EQ(monitor.width(), 64);
  EXPECT_EQ(monitor.check(image(11.0, 32, 24)), InputVerdict::kNewSize);
  EXPECT_EQ(monitor.counts().size_changes, 1);
}

TEST(InputMonitor, WhereTheSizeIsKeptItSaysSoInOneSentence) {
  InputMonitor monitor;
  monitor.keepSize();
  monitor.check(image(10.0));
  const std::string sentence =
      "the image size changed from 64 x 48 to 32 x 24; such images are left out: restart the node "
      "to calibrate the new size";
  int notices = 0;
  for (int i = 1; i < 4 * InputMonitor::kSizePatience; ++i) {
    EXPECT_EQ(monitor.check(image(10.0 + 0.1 * i, 32, 24)), InputVerdict::kReject) << i;
    EXPECT_EQ(monitor.counts().last_problem, sentence);
    const std::string notice = monitor.takeNotice();
    notices += !notice.empty();
    EXPECT_TRUE(notice.empty() || notice == sentence) << notice;
  }
  EXPECT_EQ(notices, 1) << "an event comes once";
  EXPECT_EQ(monitor.check(image(20.0)), InputVerdict::kUse);
  EXPECT_EQ(monitor.counts().size_changes, 0);
}

TEST(InputMonitor, ImagesThatTheMaskDoesNotFitAreNamed) {
  const GrayImage mask = image(0.0, 64, 48);
  InputMonitor monitor;
  monitor.setMask(*mask.view);
  EXPECT_EQ(monitor.check(image(10.0, 80, 48)), InputVerdict::kReject);
  EXPECT_NE(monitor.counts().last_problem.find("mask"), std::string::npos);
  EXPECT_EQ(monitor.check(image(10.1, 128, 96)), InputVerdict::kUse);
}

TEST(InputMonitor, ImagesWithoutAStampAreNamed) {
  InputMonitor monitor;
  EXPECT_EQ(monitor.check(image(0.0)), InputVerdict::kReject);
  EXPECT_NE(monitor.counts().last_problem.find("stamp"), std::string::npos);
  InputMonitor of_video;
  of_video.takeZeroAsTime();
  EXPECT_EQ(of_video.check(image(0.0)), InputVerdict::kUse);
  EXPECT_EQ(of_video.check(image(0.1)), InputVerdict::kUse);
}

TEST(InputMonitor, CountsImagesThatDidNotArriveAtAnyRate) {
  for (const double rate : {5.0, 20.0, 120.0}) {
    InputMonitor monitor;
    for (int i = 0; i < 200; ++i) {
      if (i == 50 || i == 100 || i == 101) continue;
      const double jitter = 0.2 * (i % 3 - 1) / rate;
      EXPECT_EQ(monitor.check(image(100.0 + i / rate + jitter)), InputVerdict::kUse);
    }
    EXPECT_EQ(monitor.counts().missed, 3) << rate << " Hz";
    EXPECT_NEAR(monitor.counts().rate_hz, rate, 0.1 * rate);
    EXPECT_EQ(monitor.counts().gaps, 0) << rate << " Hz";
  }
}

TEST(InputMonitor, ALongGapIsAnEventAndNoMissedImages) {
  InputMonitor monitor;
  for (int i = 0; i < 20; ++i) monitor.check(image(100.0 + 0.05 * i));
  EXPECT_EQ(monitor.takeNotice(), "");
  EXPECT_EQ(monitor.check(image(130.0)), InputVerdict::kUse);
  EXPECT_EQ(monitor.counts().gaps, 1);
  EXPECT_EQ(monitor.counts().missed, 0);
  EXPECT_NE(monitor.takeNotice().find("for 29"), std::string::npos);
  EXPECT_EQ(monitor.takeNotice(), "") << "an event comes once";
}

TEST(InputMonitor, PassesOnWhyAnImageCannotBeRead) {
  InputMonitor monitor;
  EXPECT_EQ(monitor.check({std::nullopt, "the image is empty"}), InputVerdict::kReject);
  EXPECT_EQ(monitor.counts().last_problem, "the image is empty");
  EXPECT_EQ(monitor.check(image(1.0)), InputVerdict::kUse);
}

}  // namespace
}  // namespace camera_self_calibration
