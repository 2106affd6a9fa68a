#include "camera_self_calibration/ros/frame_names.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

TEST(FrameNames, TheCameraIsTheChildOrElseTheFrameOfTheImages) {
  EXPECT_EQ((FrameNames{"map", "eye", "lens"}.camera()), "eye");
  EXPECT_EQ((FrameNames{"map", "", "lens"}.camera()), "lens");
  EXPECT_EQ((FrameNames{"map", "", "/lens"}.camera()), "lens") << "tf2 takes no leading slash";
  EXPECT_EQ((FrameNames{"map", "", ""}.camera()), "camera");
  EXPECT_EQ((FrameNames{"map", "", "/"}.camera()), "camera");
}

TEST(FrameNames, EqualNamesAreAProblem) {
  EXPECT_EQ((FrameNames{"map", "", "lens"}.problem()), "");
  EXPECT_NE((FrameNames{"map", "", "map"}.problem().find("world_frame")), std::string::npos);
  EXPECT_NE((FrameNames{"/map", "", "map"}.problem()), "");
}

}  // namespace
}  // namespace camera_self_calibration
