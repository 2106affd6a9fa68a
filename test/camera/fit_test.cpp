#include "camera_self_calibration/camera/fit.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <iostream>

#include "camera/sample_cameras.h"

namespace camera_self_calibration {
namespace {

// A fov camera of 640 x 480 whose diagonal spans `degrees`.
Camera fovOfAngle(double w, double degrees) {
  const double u = 2.0 * std::tan(0.5 * w) * std::tan(0.5 * degrees / 180.0 * M_PI);
  const double f = std::hypot(319.5, 239.5) * w / std::atan(u);
  return camera640(CameraModel::kFov, {f, f, 319.5, 239.5, w});
}

// Largest error that a lens may have [px]: what a polynomial of ninth degree can do gets worse for
// strong distortion seen far from the axis.
double errorLimit(double w, double degrees) {
  if (w > 1.0 && degrees > 90.0) return w > 1.3 ? 0.7 : 0.15;
  if (w > 1.3) return degrees > 60.0 ? 0.05 : 0.01;
  return w < 0.9 ? 0.05 : 0.01;
}

TEST(FitCamera, FovToEquidistantIsCloseForEveryLens) {
  for (const double w : {0.5, 0.6, 0.7, 0.9, 1.0, 1.2, 1.4}) {
    for (const double degrees : {60.0, 90.0, 120.0, 150.0}) {
      const auto fit = fitCamera(fovOfAngle(w, degrees), CameraModel::kEquidistant);
      ASSERT_TRUE(fit);
      std::cout << "w " << w << ", " << degrees << " deg: rms " << fit->error.rms << " px, max "
                << fit->error.max << " px\n";
      EXPECT_LT(fit->error.max, errorLimit(w, degrees)) << "w " << w << ", " << degrees;
      EXPECT_EQ(fit->camera.model(), CameraModel::kEquidistant);
    }
  }
}

// With the centre and fx = fy given the fit is linear: radius = f theta + f k1 theta^3 + ...
TEST(FitCamera, IsAsGoodAsTheLinearFit) {
  for (const Camera& source :
       {fovOfAngle(0.5, 150.0), fovOfAngle(1.2, 150.0), fovOfAngle(1.4, 150.0),
        camera640(CameraModel::kRadtan, {458, 458, 319.5, 239.5, -0.283, 0.0739, 0, 0})}) {
    Eigen::Matrix<double, 1200, 5> powers;
    Eigen::Matrix<double, 1200, 1> radii;
    for (int i = 0; i < 1200; ++i) {
      const Eigen::Vector2d pixel(i % 40 * 639.0 / 39.0, i / 40 * 479.0 / 29.0);
      const double theta = std::acos(source.unproject(pixel)->z());
      for (int j = 0; j < 5; ++j) powers(i, j) = std::pow(theta, 2 * j + 1);
      radii[i] = (pixel - source.parameters().segment<2>(2)).norm();
    }
    const Eigen::Matrix<double, 5, 1> best = powers.colPivHouseholderQr().solve(radii);
    const double linear_rms = (powers * best - radii).norm() / std::sqrt(1200.0);
    const auto fit = fitCamera(source, CameraModel::kEquidistant);
    ASSERT_TRUE(fit);
    EXPECT_LT(fit->error.rms, 1.0001 * linear_rms) << describe(source);
  }
}

TEST(FitCamera, TheErrorIsTheDirectDistance) {
  const Camera source = fovOfAngle(0.5, 150.0);
  const auto fit = fitCamera(source, CameraModel::kEquidistant);
  ASSERT_TRUE(fit);
  double sum = 0.0;
  int count = 0;
  for (double y = 1.5; y < 480; y += 7.0) {
    for (double x = 1.5; x < 640; x += 7.0) {
      Eigen::Vector2d pixel;
      ASSERT_TRUE(fit->camera.project(*source.unproject({x, y}), &pixel));
      sum += (pixel - Eigen::Vector2d(x, y)).squaredNorm();
      ++count;
    }
  }
  EXPECT_NEAR(std::sqrt(sum / count), fit->error.rms, 0.2 * fit->error.rms);
}

TEST(FitCamera, ToTheSameModelIsTheSameCamera) {
  for (const Camera& camera : sampleCameras()) {
    const auto fit = fitCamera(camera, camera.model());
    ASSERT_TRUE(fit);
    EXPECT_LT(fit->error.max, 1e-9) << describe(camera);
    EXPECT_LT((fit->camera.parameters() - camera.parameters()).norm(), 1e-6) << describe(camera);
    EXPECT_EQ(fit->camera.estimatedCount(), camera.estimatedCount());
  }
}

TEST(FitCamera, PinholeToEveryModel) {
  const Camera pinhole = camera640(CameraModel::kPinhole, {420, 425, 310, 250});
  for (const CameraModel model : {CameraModel::kPinhole, CameraModel::kFov, CameraModel::kRadtan,
                                  CameraModel::kEquidistant}) {
    const auto fit = fitCamera(pinhole, model);
    ASSERT_TRUE(fit);
    EXPECT_LT(fit->error.max, 0.01) << toString(model);
    EXPECT_EQ(fit->camera.width(), 640);
    EXPECT_EQ(fit->camera.height(), 480);
  }
}

TEST(FitCamera, RadtanToEquidistantAndBack) {
  const Camera radtan =
      camera640(CameraModel::kRadtan, {458.7, 457.3, 337.2, 248.4, -0.283, 0.0739, 0, 0});
  const auto there = fitCamera(radtan, CameraModel::kEquidistant);
  ASSERT_TRUE(there);
  EXPECT_LT(there->error.max, 0.6);
  EXPECT_LT(there->error.rms, 0.1);
  const auto back = fitCamera(there->camera, CameraModel::kRadtan);
  ASSERT_TRUE(back);
  EXPECT_LT(back->error.max, 0.6);
  EXPECT_LT(pixelDistance(radtan, back->camera).max, 0.2);
  EXPECT_EQ(back->camera.parameterCount(), 9);
  EXPECT_EQ(back->camera.estimatedCount(), 8);
}

TEST(FitCamera, EquidistantToFovFindsW) {
  const Camera fov = fovOfAngle(1.1, 120.0);
  const auto equidistant = fitCamera(fov, CameraModel::kEquidistant);
  ASSERT_TRUE(equidistant);
  const auto back = fitCamera(equidistant->camera, CameraModel::kFov);
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->camera.parameters()[4], 1.1, 1e-3);
  EXPECT_LT(back->error.max, 0.01);
}

// A polynomial in the tangent cannot follow a wide lens: the error must say so.
TEST(FitCamera, ReportsAPoorFit) {
  const auto fit = fitCamera(fovOfAngle(0.93, 150.0), CameraModel::kRadtan);
  ASSERT_TRUE(fit);
  EXPECT_GT(fit->error.max, 1.0);
}

// Rays behind the image plane have no pixel in a pinhole camera.
TEST(FitCamera, RaysThatTheTargetRefusesMakeTheErrorInfinite) {
  const Camera wide = camera640(CameraModel::kEquidistant, {180, 180, 319.5, 239.5, 0, 0, 0, 0});
  const auto fit = fitCamera(wide, CameraModel::kPinhole);
  ASSERT_TRUE(fit);
  EXPECT_TRUE(std::isinf(fit->error.max));
  EXPECT_TRUE(std::isinf(fit->error.rms));
}

TEST(FitCamera, NothingWithoutRays) {
  EXPECT_FALSE(fitCamera(Camera(), CameraModel::kEquidistant));
  EXPECT_FALSE(fitCamera(camera640(CameraModel::kFov, {300, 300, 320, 240, -1.0}),
                         CameraModel::kEquidistant));
}

}  // namespace
}  // namespace camera_self_calibration
