#include "camera_self_calibration/camera/plausibility.h"

#include <gtest/gtest.h>

#include <string>

#include "camera/sample_cameras.h"

namespace camera_self_calibration {
namespace {

std::string problemOf(double fx, double fy, double cx, double cy) {
  return implausibility(camera640(CameraModel::kPinhole, {fx, fy, cx, cy}));
}

TEST(Plausibility, OfRealLenses) {
  EXPECT_EQ(problemOf(420, 415, 325, 236), "");
  EXPECT_EQ(problemOf(19000, 19000, 320, 240), "") << "a telescope of two degrees";
  EXPECT_EQ(problemOf(800, 400, 320, 120), "") << "half the lines of interlaced video";
  EXPECT_EQ(problemOf(9000, 9000, 6000, -5000), "") << "cut out of a larger image";
  for (const CameraModel model : {CameraModel::kPinhole, CameraModel::kFov, CameraModel::kRadtan,
                                  CameraModel::kEquidistant}) {
    EXPECT_EQ(implausibility(Camera::defaultGuess(model, 640, 480)), "");
  }
  EXPECT_EQ(implausibility(camera640(CameraModel::kEquidistant, {160, 160, 320, 240, 0, 0, 0, 0})),
            "")
      << "a lens of 230 degrees";
}

TEST(Plausibility, OfValuesThatNoCameraHas) {
  EXPECT_NE(problemOf(20, 20, 320, 240).find("20 px"), std::string::npos);
  EXPECT_NE(problemOf(4.2, 4.2, 3.2, 2.4).find("millimetres"), std::string::npos);
  EXPECT_NE(problemOf(1e300, 1e300, 320, 240), "");
  EXPECT_NE(problemOf(400, 70, 320, 240), "");
  EXPECT_NE(problemOf(400, 400, 20000, 240).find("principal point"), std::string::npos);
  EXPECT_NE(problemOf(-400, 400, 320, 240), "");
  EXPECT_NE(implausibility(Camera(CameraModel::kPinhole, 0, 0, Eigen::Vector4d(400, 400, 1, 1))),
            "");
  EXPECT_NE(implausibility(
                Camera(CameraModel::kPinhole, 40000, 30000, Eigen::Vector4d(4e4, 4e4, 2e4, 1e4)))
                .find("too large"),
            std::string::npos);
}

}  // namespace
}  // namespace camera_self_calibration
