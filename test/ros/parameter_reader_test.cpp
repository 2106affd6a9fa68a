#include "camera_self_calibration/ros/parameter_reader.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

const std::vector<std::string> kKnown = {"alpha",      "model",     "max_features", "path_poses",
                                         "publish_tf", "invert_tf", "camera_name",  "state_file"};

TEST(NearestName, FindsWhatWasMeant) {
  EXPECT_EQ(nearestName("max_featurs", kKnown), "max_features");
  EXPECT_EQ(nearestName("modle", kKnown), "model");
  EXPECT_EQ(nearestName("pulbish_tf", kKnown), "publish_tf");
  EXPECT_EQ(nearestName("Alpha", kKnown), "alpha");
  EXPECT_EQ(nearestName("camera_names", kKnown), "camera_name");
  EXPECT_EQ(nearestName("statefile", kKnown), "state_file");
}

TEST(NearestName, NothingIsNear) {
  EXPECT_EQ(nearestName("exposure", kKnown), "");
  EXPECT_EQ(nearestName("x", kKnown), "");
  EXPECT_EQ(nearestName("alpha", {}), "");
}

}  // namespace
}  // namespace camera_self_calibration
