// What image_geometry, with which most consumers read a CameraInfo, makes of ours.

#include <gtest/gtest.h>
#include <image_geometry/pinhole_camera_model.h>

#include <algorithm>
#include <vector>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/ros/camera_info.h"

namespace camera_self_calibration {
namespace {

struct Case {
  Camera camera;
  OutputModel output = OutputModel::kAuto;
};

const Camera kFov = camera640(CameraModel::kFov, {311.2, 309.8, 327.4, 233.1, 0.93});

std::vector<Case> cases() {
  return {{camera640(CameraModel::kPinhole, {500, 510, 320, 240})},
          {camera640(CameraModel::kRadtan, {520, 522, 325, 245, -0.15, 0.04, 4e-4, -6e-4})},
          {camera640(CameraModel::kRadtan, {520, 522, 325, 245, 0.12, -0.05, 4e-4, -6e-4, 0.01})},
          {camera640(CameraModel::kEquidistant, {300, 301, 320, 240, 0.01, -0.002, 0.001, 0.0})},
          {kFov},
          {camera640(CameraModel::kRadtan, {520, 522, 325, 245, -0.15, 0.04, 4e-4, -6e-4}),
           OutputModel::kRationalPolynomial}};
}

/// Lenses so strongly bent that OpenCV's five rounds from a raw pixel to its ray do not suffice.
std::vector<Case> strongCases() {
  return {{Camera(CameraModel::kRadtan, 752, 480,
                  intrinsics({458.7, 457.3, 367.2, 248.4, -0.283, 0.0739, 2e-4, 1.8e-5}))},
          {kFov, OutputModel::kRationalPolynomial}};
}

image_geometry::PinholeCameraModel modelOf(const Case& c) {
  const auto conversion = toCameraInfo(c.camera, c.output);
  EXPECT_TRUE(conversion) << describe(c.camera);
  image_geometry::PinholeCameraModel model;
  model.fromCameraInfo(conversion->info);
  return model;
}

/// Calls visit(pixel, ray) over the image, border included.
template <typename Visit>
void overImage(const Camera& camera, const Visit& visit) {
  constexpr int kSteps = 30;
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const Eigen::Vector2d pixel(column * (camera.width() - 1.0) / kSteps,
                                  row * (camera.height() - 1.0) / kSteps);
      const auto ray = camera.unproject(pixel);
      ASSERT_TRUE(ray);
      visit(pixel, *ray);
    }
  }
}

TEST(ImageGeometry, ProjectsAPointToTheRawPixelWhereTheLensSeesIt) {
  std::vector<Case> all = cases();
  for (const Case& c : strongCases()) all.push_back(c);
  for (const Case& c : all) {
    const auto model = modelOf(c);
    double largest = 0.0;
    overImage(c.camera, [&](const Eigen::Vector2d& pixel, const Eigen::Vector3d& ray) {
      const cv::Point2d rectified = model.project3dToPixel({ray.x(), ray.y(), ray.z()});
      const cv::Point2d raw = model.unrectifyPoint(rectified);
      largest = std::max(largest, (Eigen::Vector2d(raw.x, raw.y) - pixel).norm());
    });
    EXPECT_LT(largest, 0.05) << describe(c.camera);
  }
}

TEST(ImageGeometry, TheRoundTripThroughRectifiedPixelsCloses) {
  for (const Case& c : cases()) {
    const auto model = modelOf(c);
    double largest = 0.0;
    overImage(c.camera, [&](const Eigen::Vector2d& pixel, const Eigen::Vector3d&) {
      const cv::Point2d raw(pixel.x(), pixel.y());
      const cv::Point2d back = model.unrectifyPoint(model.rectifyPoint(raw));
      largest = std::max(largest, std::hypot(back.x - raw.x, back.y - raw.y));
    });
    EXPECT_LT(largest, 0.05) << describe(c.camera) << " to " << static_cast<int>(c.output);
  }
}

TEST(ImageGeometry, ARectifiedPixelIsARayOfTheLens) {
  for (const Case& c : cases()) {
    const auto model = modelOf(c);
    double largest = 0.0;
    overImage(c.camera, [&](const Eigen::Vector2d& pixel, const Eigen::Vector3d&) {
      const cv::Point3d seen =
          model.projectPixelTo3dRay(model.rectifyPoint({pixel.x(), pixel.y()}));
      const Eigen::Vector3d direction = Eigen::Vector3d(seen.x, seen.y, seen.z).normalized();
      Eigen::Vector2d reprojected;
      ASSERT_TRUE(c.camera.project(direction, &reprojected));
      largest = std::max(largest, (reprojected - pixel).norm());
    });
    EXPECT_LT(largest, 0.05) << describe(c.camera) << " to " << static_cast<int>(c.output);
  }
}

TEST(ImageGeometry, ZerosMeanUncalibrated) {
  image_geometry::PinholeCameraModel model;
  model.fromCameraInfo(uncalibratedCameraInfo(640, 480));
  EXPECT_EQ(model.fx(), 0.0);
}

}  // namespace
}  // namespace camera_self_calibration
