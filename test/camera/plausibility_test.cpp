#include "camera_self_calibration/camera/plausibility.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

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
  EXPECT_EQ(implausibility(camera640(CameraModel::kRadtan,
                                     {9000, 9000, 320, 240, 0.4, -30, 0.001, 0.002, 4000})),
            "")
      << "a long lens, whose coefficients are nearly free";
}

TEST(Plausibility, OfDistortionThatNoLensHas) {
  const auto problem = [](CameraModel model, std::size_t coefficient, double value) {
    std::vector<double> values = {400, 400, 320, 240, -0.2, 0.1, 0, 0};
    values[coefficient] = value;
    return implausibility(
        Camera(model, 640, 480, Eigen::Map<const Eigen::VectorXd>(values.data(), 8)));
  };
  EXPECT_NE(problem(CameraModel::kRadtan, 4, 1e30).find("k1 = 1e+30"), std::string::npos);
  EXPECT_NE(problem(CameraModel::kRadtan, 6, -1e30).find("p1 = -1e+30"), std::string::npos);
  EXPECT_NE(problem(CameraModel::kEquidistant, 7, 1e6).find("k4 = 1e+06"), std::string::npos);
  for (std::size_t i = 4; i < 8; ++i) {
    EXPECT_EQ(problem(CameraModel::kRadtan, i, 2.0), "") << i;
    EXPECT_EQ(problem(CameraModel::kEquidistant, i, -2.0), "") << i;
  }
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
