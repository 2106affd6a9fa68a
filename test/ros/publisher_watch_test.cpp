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

TEST(PublisherWatch, ThreeCamerasInTurnAreAllNamed) {
  PublisherWatch watch;
  for (const char* name : {"/left", "/right", "/rear", "/left"}) EXPECT_EQ(watch.check(name), "");
  watch.check("/right");
  for (int i = 0; i < 3 * PublisherWatch::kPatience; ++i) {
    for (const char* name : {"/rear", "/right"}) {
      const std::string problem = watch.check(name);
      EXPECT_NE(problem.find("3 nodes publish images on the topic, /left, /right and /rear; those "
                             "of /left are used"),
                std::string::npos)
          << problem;
    }
    EXPECT_EQ(watch.check("/left"), "");
  }
}

TEST(PublisherWatch, ASlowSecondCameraIsNamed) {
  PublisherWatch watch;
  const auto many = [&watch] {
    for (int i = 0; i < 2 * PublisherWatch::kPatience; ++i) EXPECT_EQ(watch.check("/fast"), "");
  };
  many();
  watch.check("/slow");  // It might have been started anew.
  for (int i = 0; i < 3; ++i) {
    many();
    EXPECT_NE(watch.check("/slow").find("/fast and /slow"), std::string::npos);
  }
}

TEST(PublisherWatch, ACameraThatIsStartedAnewUnderAFormerNameIsTaken) {
  PublisherWatch watch;
  for (const char* name : {"/a", "/b", "/a", "/c", "/b"}) {
    for (int i = 0; i < 2 * PublisherWatch::kPatience; ++i) EXPECT_EQ(watch.check(name), "");
  }
}

TEST(PublisherWatch, ItForgetsWhoPublishedLongAgo) {
  PublisherWatch watch;
  for (int start = 0; start < 100; ++start) {
    const std::string name = "/play_" + std::to_string(start);
    EXPECT_EQ(watch.check(name), "");
    EXPECT_EQ(watch.check(name), "");
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
