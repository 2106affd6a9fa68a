#include "camera_self_calibration/ros/publisher_watch.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

TEST(PublisherWatch, ACameraThatIsStartedAnewIsTaken) {
  PublisherWatch watch;
  for (const char* name : {"/play_1", "/play_1", "/play_2", "/play_2", "/play_3"}) {
    EXPECT_EQ(watch.check(name), "") << name;
  }
}

TEST(PublisherWatch, TwoCamerasAreNamedAndTheFirstOneGoesOn) {
  PublisherWatch watch;
  watch.check("/left");
  watch.check("/right");  // It might have been started anew ...
  EXPECT_EQ(watch.check("/left"), "") << "... but it was not";
  for (int i = 0; i < 3 * PublisherWatch::kPatience; ++i) {
    const std::string problem = watch.check("/right");
    EXPECT_NE(problem.find("/left and /right"), std::string::npos) << problem;
    EXPECT_EQ(watch.check("/left"), "");
  }
}

TEST(PublisherWatch, TheSecondOneIsTakenWhenTheFirstHasEnded) {
  PublisherWatch watch;
  for (const char* name : {"/left", "/right", "/left"}) watch.check(name);
  for (int i = 0; i < PublisherWatch::kPatience; ++i) EXPECT_NE(watch.check("/right"), "");
  EXPECT_EQ(watch.check("/right"), "");
  EXPECT_EQ(watch.check("/right"), "");
}

}  // namespace
}  // namespace camera_self_calibration
