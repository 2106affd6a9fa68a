#include "camera_self_calibration/ros/camera_info.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/ros/model_conversion.h"

namespace camera_self_calibration {
namespace {

Camera makeCamera(CameraModel model, const std::vector<double>& values) {
  return Camera(
      model, 640, 480,
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
}

TEST(CameraInfo, PinholeIsPlumbBobWithZeros) {
  const auto conversion = toCameraInfo(makeCamera(CameraModel::kPinhole, {500, 510, 320, 240}));
  ASSERT_TRUE(conversion);
  const sensor_msgs::CameraInfo& info = conversion->info;
  EXPECT_EQ(info.distortion_model, "plumb_bob");
  EXPECT_EQ(info.D, std::vector<double>(5, 0.0));
  EXPECT_EQ(info.width, 640u);
  EXPECT_EQ(info.height, 480u);
  const boost::array<double, 9> k = {500, 0, 320, 0, 510, 240, 0, 0, 1};
  const boost::array<double, 9> r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const boost::array<double, 12> p = {500, 0, 320, 0, 0, 510, 240, 0, 0, 0, 1, 0};
  EXPECT_EQ(info.K, k);
  EXPECT_EQ(info.R, r);
  EXPECT_EQ(info.P, p);
  EXPECT_EQ(conversion->error.max, 0.0);
}

TEST(CameraInfo, RadtanKeepsItsCoefficients) {
  const auto without_k3 = toCameraInfo(
      makeCamera(CameraModel::kRadtan, {421, 422, 354, 252, -0.33, 0.16, 0.001, -0.002}));
  ASSERT_TRUE(without_k3);
  EXPECT_EQ(without_k3->info.D, (std::vector<double>{-0.33, 0.16, 0.001, -0.002, 0.0}));
  const auto with_k3 = toCameraInfo(
      makeCamera(CameraModel::kRadtan, {421, 422, 354, 252, -0.33, 0.16, 0.001, -0.002, -0.05}));
  ASSERT_TRUE(with_k3);
  EXPECT_EQ(with_k3->info.distortion_model, "plumb_bob");
  EXPECT_EQ(with_k3->info.D, (std::vector<double>{-0.33, 0.16, 0.001, -0.002, -0.05}));
}

TEST(CameraInfo, FovGoesOutAsEquidistantWithinTheStatedError) {
  // The largest error over the image [px] for each w, at a field of 150 degrees over the diagonal.
  for (const auto& [w, limit] : {std::pair(0.5, 0.05), std::pair(0.9, 0.01), std::pair(1.2, 0.2)}) {
    const double edge = std::tan(75.0 * kDegree);
    const double f = 400.0 * w / std::atan(2.0 * edge * std::tan(w / 2.0));
    const Camera fov = makeCamera(CameraModel::kFov, {f, f, 319.5, 239.5, w});
    const auto conversion = toCameraInfo(fov);
    ASSERT_TRUE(conversion);
    EXPECT_EQ(conversion->info.distortion_model, "equidistant");
    ASSERT_EQ(conversion->info.D.size(), 4u);
    EXPECT_LT(conversion->error.max, limit) << "w = " << w;
    const std::optional<Camera> read = toCamera(conversion->info);
    ASSERT_TRUE(read);
    // The distance with the best rotation cannot exceed the direct one that is stated.
    EXPECT_LE(pixelDistance(fov, *read).rms, conversion->error.rms + 1e-6) << "w = " << w;
  }
}

TEST(CameraInfo, GoesOutInTheModelAskedForWithItsError) {
  const Camera fov = makeCamera(CameraModel::kFov, {311, 310, 327, 233, 0.93});
  const Camera radtan =
      makeCamera(CameraModel::kRadtan, {421, 422, 354, 252, -0.33, 0.16, 0.001, -0.002});
  const auto rational = toCameraInfo(fov, OutputModel::kRationalPolynomial);
  ASSERT_TRUE(rational);
  EXPECT_EQ(rational->info.distortion_model, "rational_polynomial");
  EXPECT_EQ(rational->info.D.size(), 8u);
  EXPECT_GT(rational->error.max, 0.0);
  EXPECT_LT(rational->error.max, 0.1);
  const auto plumb_bob = toCameraInfo(fov, OutputModel::kPlumbBob);
  ASSERT_TRUE(plumb_bob);
  EXPECT_EQ(plumb_bob->info.distortion_model, "plumb_bob");
  EXPECT_EQ(plumb_bob->info.D.size(), 5u);
  EXPECT_GT(plumb_bob->error.max, 0.1) << "five coefficients are too few for such a lens";
  const auto equidistant = toCameraInfo(radtan, OutputModel::kEquidistant);
  ASSERT_TRUE(equidistant);
  EXPECT_EQ(equidistant->info.distortion_model, "equidistant");
  EXPECT_GT(equidistant->error.max, 0.0) << "it has no tangential terms";
  const auto exact = toCameraInfo(radtan, OutputModel::kRationalPolynomial);
  ASSERT_TRUE(exact);
  EXPECT_EQ(exact->error.max, 0.0);
  EXPECT_EQ(exact->info.D, (std::vector<double>{-0.33, 0.16, 0.001, -0.002, 0, 0, 0, 0}));
}

TEST(CameraInfo, OnlyStandardNamesAreOutputModels) {
  for (const char* name : {"auto", "plumb_bob", "rational_polynomial", "equidistant"}) {
    EXPECT_TRUE(outputModelFromString(name)) << name;
  }
  for (const char* name : {"fov", "radtan", "", "thin_prism"}) {
    EXPECT_FALSE(outputModelFromString(name)) << name;
  }
}

TEST(CameraInfo, ReadsBackWhatItWrote) {
  for (const Camera& camera :
       {makeCamera(CameraModel::kPinhole, {500, 510, 320, 240}),
        makeCamera(CameraModel::kRadtan, {421, 422, 354, 252, -0.33, 0.16, 0.001, -0.002}),
        makeCamera(CameraModel::kRadtan, {421, 422, 354, 252, -0.33, 0.16, 0.001, -0.002, -0.05}),
        makeCamera(CameraModel::kEquidistant, {300, 301, 320, 240, 0.01, -0.002, 0.001, 0.0})}) {
    const auto conversion = toCameraInfo(camera);
    ASSERT_TRUE(conversion);
    const std::optional<Camera> read = toCamera(conversion->info);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->model(), camera.model());
    EXPECT_EQ(read->parameters(), camera.parameters());
    EXPECT_EQ(read->width(), camera.width());
    EXPECT_EQ(read->height(), camera.height());
  }
}

TEST(CameraInfo, WithoutCoefficientsItIsAPinholeCamera) {
  sensor_msgs::CameraInfo info =
      toCameraInfo(makeCamera(CameraModel::kPinhole, {500, 510, 320, 240}))->info;
  info.D.clear();
  for (const char* model : {"plumb_bob", "rational_polynomial"}) {
    info.distortion_model = model;
    const std::optional<Camera> camera = toCamera(info);
    ASSERT_TRUE(camera) << model;
    EXPECT_EQ(camera->model(), CameraModel::kPinhole) << model;
  }
}

TEST(CameraInfo, UncalibratedIsAllZeros) {
  const sensor_msgs::CameraInfo info = uncalibratedCameraInfo(640, 480);
  EXPECT_EQ(info.width, 640u);
  EXPECT_EQ(info.K[0], 0.0);
  EXPECT_EQ(info.P[0], 0.0);
  EXPECT_TRUE(info.D.empty());
  EXPECT_TRUE(info.distortion_model.empty());
  EXPECT_FALSE(toCamera(info));
}

TEST(CameraInfo, RefusesImagesLargerThanAnyCamerasAre) {
  sensor_msgs::CameraInfo info =
      toCameraInfo(makeCamera(CameraModel::kPinhole, {500, 510, 320, 240}))->info;
  for (const char* model : {"plumb_bob", "rational_polynomial", "equidistant"}) {
    info.distortion_model = model;
    info.D.assign(info.distortion_model == "rational_polynomial" ? 8 : 0, 0.1);
    for (const std::uint32_t width : {40000u, 252579083u, 0xFFFFFFFFu}) {
      info.width = width;
      EXPECT_FALSE(toCamera(info, CameraModel::kFov)) << model << ' ' << width;
      EXPECT_NE(whyNoStart(info, {}).find("no camera has images of"), std::string::npos);
    }
    info.width = 0;
    info.height = 576651263u;
    EXPECT_FALSE(toCamera(info, CameraModel::kFov)) << model;
    info.height = 480;
  }
}

TEST(CameraInfo, RefusesWhatItCannotRead) {
  sensor_msgs::CameraInfo info =
      toCameraInfo(makeCamera(CameraModel::kPinhole, {500, 510, 320, 240}))->info;
  info.distortion_model = "fov";
  EXPECT_FALSE(toCamera(info));
  info.distortion_model = "plumb_bob";
  info.D.resize(3);
  EXPECT_FALSE(toCamera(info));
  EXPECT_FALSE(toCameraInfo(makeCamera(CameraModel::kFov, {311, 310, 327, 233, -1.0})));
}

}  // namespace
}  // namespace camera_self_calibration
