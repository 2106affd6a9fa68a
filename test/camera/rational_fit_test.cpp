#include "camera_self_calibration/camera/rational_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <opencv2/calib3d.hpp>

#include "camera/sample_cameras.h"

namespace camera_self_calibration {
namespace {

Eigen::Vector2d openCvPixel(const RationalPolynomial& c, const Eigen::Vector3d& point) {
  const cv::Matx33d k(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  const std::vector<double> d(c.coefficients.begin(), c.coefficients.end());
  const std::vector<cv::Point3d> points = {{point.x(), point.y(), point.z()}};
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), k, d, pixels);
  return {pixels[0].x, pixels[0].y};
}

TEST(RationalPolynomial, ProjectsAsOpenCv) {
  const RationalPolynomial camera{
      400, 410, 320, 240, {0.3, -0.05, 0.001, -0.002, 0.01, 0.2, 0.03, 0.004}};
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0.4, -0.3, 1.0), Eigen::Vector3d(-1.0, 0.7, 0.8)}) {
    Eigen::Vector2d pixel;
    ASSERT_TRUE(camera.project(point, &pixel));
    EXPECT_LT((pixel - openCvPixel(camera, point)).norm(), 1e-9);
  }
  Eigen::Vector2d pixel;
  EXPECT_FALSE(camera.project(Eigen::Vector3d(0.1, 0.1, -1.0), &pixel));
}

TEST(RationalFit, IsExactForPinholeAndRadtan) {
  for (const Camera& source : sampleCameras()) {
    if (source.model() != CameraModel::kPinhole && source.model() != CameraModel::kRadtan) continue;
    const auto fit = fitRationalPolynomial(source);
    ASSERT_TRUE(fit) << describe(source);
    EXPECT_EQ(fit->error.max, 0.0);
    const auto ray = source.unproject({100.0, 400.0});
    ASSERT_TRUE(ray) << describe(source);
    EXPECT_LT((openCvPixel(fit->camera, *ray) - Eigen::Vector2d(100.0, 400.0)).norm(), 1e-6);
  }
}

Camera fovOfAngle(double w, double degrees) {
  const double u = 2.0 * std::tan(0.5 * w) * std::tan(0.5 * degrees / 180.0 * M_PI);
  const double f = std::hypot(319.5, 239.5) * w / std::atan(u);
  return camera640(CameraModel::kFov, {f, f, 319.5, 239.5, w});
}

TEST(RationalFit, FovIsCloseForEveryLens) {
  for (const double w : {0.5, 0.9, 1.2}) {
    for (const double degrees : {60.0, 90.0, 120.0, 150.0}) {
      const Camera source = fovOfAngle(w, degrees);
      const auto fit = fitRationalPolynomial(source);
      ASSERT_TRUE(fit);
      std::cout << "w " << w << ", " << degrees << " deg: max " << fit->error.max << " px\n";
      EXPECT_LT(fit->error.max, degrees > 120.0 ? 0.2 : 0.02) << "w " << w << ", " << degrees;
    }
  }
}

TEST(RationalFit, StatesTheErrorItHas) {
  const Camera source =
      camera640(CameraModel::kEquidistant, {300, 290, 330, 230, -0.12, 0.05, 0, 0});
  const auto fit = fitRationalPolynomial(source);
  ASSERT_TRUE(fit);
  double largest = 0.0;
  for (const Eigen::Vector2d& pixel :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(639, 479), Eigen::Vector2d(330, 0),
        Eigen::Vector2d(639, 230), Eigen::Vector2d(150, 300)}) {
    const auto ray = source.unproject(pixel);
    ASSERT_TRUE(ray);
    largest = std::max(largest, (openCvPixel(fit->camera, *ray) - pixel).norm());
  }
  EXPECT_LE(largest, fit->error.max + 1e-3);
  // A field of more than 180 degrees has rays that no such polynomial projects.
  const Camera fisheye = camera640(CameraModel::kEquidistant, {190, 190, 319.5, 239.5, 0, 0, 0, 0});
  const auto impossible = fitRationalPolynomial(fisheye);
  EXPECT_TRUE(!impossible || std::isinf(impossible->error.max));
}

}  // namespace
}  // namespace camera_self_calibration
