#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <vector>

#include "camera/sample_cameras.h"

namespace camera_self_calibration {
namespace {

std::vector<cv::Point3d> samplePoints(double widest_tangent) {
  std::vector<cv::Point3d> points;
  for (int i = -5; i <= 5; ++i) {
    for (int j = -5; j <= 5; ++j) {
      points.emplace_back(1.7 * widest_tangent * i / 7.1, 1.7 * widest_tangent * j / 7.1, 1.7);
    }
  }
  return points;
}

cv::Matx33d cameraMatrix(const Camera& camera) {
  const Intrinsics& p = camera.parameters();
  return {p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1};
}

// OpenCV's order k1 k2 p1 p2 k3 is that of our radtan, and k1..k4 that of our equidistant.
std::vector<double> coefficients(const Camera& camera) {
  return {camera.parameters().data() + 4, camera.parameters().data() + camera.parameterCount()};
}

void expectSamePixels(const Camera& camera, const std::vector<cv::Point3d>& points,
                      const std::vector<cv::Point2d>& pixels) {
  int compared = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Vector2d pixel;
    if (!camera.project({points[i].x, points[i].y, points[i].z}, &pixel)) continue;
    EXPECT_LT((pixel - Eigen::Vector2d(pixels[i].x, pixels[i].y)).norm(), 1e-9)
        << describe(camera) << " point " << points[i];
    ++compared;
  }
  EXPECT_GT(compared, 40) << describe(camera);
}

TEST(OpenCvAgreement, RadtanProjects) {
  for (const Camera& camera : sampleCameras()) {
    if (camera.model() != CameraModel::kRadtan) continue;
    const std::vector<cv::Point3d> points = samplePoints(0.9);
    std::vector<cv::Point2d> pixels;
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), cameraMatrix(camera), coefficients(camera),
                      pixels);
    expectSamePixels(camera, points, pixels);
  }
}

TEST(OpenCvAgreement, EquidistantProjects) {
  for (const Camera& camera : sampleCameras()) {
    if (camera.model() != CameraModel::kEquidistant) continue;
    const std::vector<cv::Point3d> points = samplePoints(3.0);
    std::vector<cv::Point2d> pixels;
    cv::fisheye::projectPoints(points, pixels, cv::Vec3d(), cv::Vec3d(), cameraMatrix(camera),
                               coefficients(camera));
    expectSamePixels(camera, points, pixels);
  }
}

// Derivatives with respect to fx fy cx cy and the distortion, which projectPoints gives too.
TEST(OpenCvAgreement, RadtanDerivatives) {
  const Camera camera = sampleCameras()[11];
  ASSERT_EQ(camera.parameterCount(), 9);
  const std::vector<cv::Point3d> points = samplePoints(0.5);
  std::vector<cv::Point2d> pixels;
  cv::Mat jacobian;  // columns: rotation 3, translation 3, fx fy cx cy, k1 k2 p1 p2 k3
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), cameraMatrix(camera), coefficients(camera),
                    pixels, jacobian);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Vector2d pixel;
    Matrix23d d_point;
    PixelIntrinsicsJacobian d_parameters;
    ASSERT_TRUE(
        camera.project({points[i].x, points[i].y, points[i].z}, &pixel, &d_point, &d_parameters));
    for (int row = 0; row < 2; ++row) {
      const double* expected = jacobian.ptr<double>(2 * static_cast<int>(i) + row);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(d_point(row, k), expected[3 + k], 1e-9);
      for (int k = 0; k < 9; ++k) EXPECT_NEAR(d_parameters(row, k), expected[6 + k], 1e-9);
    }
  }
}

}  // namespace
}  // namespace camera_self_calibration
