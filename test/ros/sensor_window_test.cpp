#include "camera_self_calibration/ros/sensor_window.h"

#include <gtest/gtest.h>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/ros/camera_info.h"

namespace camera_self_calibration {
namespace {

sensor_msgs::CameraInfo fullInfo() {
  return toCameraInfo(camera640(CameraModel::kRadtan, {500, 510, 322, 238, -0.2, 0.05, 0, 0}))
      ->info;
}

TEST(SensorWindow, ZerosMeanTheWholeSensor) {
  const auto window = sensorWindow(fullInfo());
  ASSERT_TRUE(window);
  EXPECT_EQ(window->imageWidth(), 640);
  EXPECT_EQ(window->imageHeight(), 480);
  EXPECT_EQ(window->binning_x, 1);
}

// The pixel that a ray meets in the full image, averaged or cut out, is the one it meets in the
// other image.
TEST(SensorWindow, TheRescaledCameraSeesTheSamePoints) {
  sensor_msgs::CameraInfo info = fullInfo();
  const auto whole = sensorWindow(info);
  info.binning_x = info.binning_y = 2;
  info.roi.x_offset = 100;
  info.roi.y_offset = 60;
  info.roi.width = 400;
  info.roi.height = 300;
  const auto part = sensorWindow(info);
  ASSERT_TRUE(whole && part);
  EXPECT_EQ(part->imageWidth(), 200);
  EXPECT_EQ(part->imageHeight(), 150);
  const Camera camera = *toCamera(info);
  const auto cut = throughWindow(camera, *whole, *part);
  ASSERT_TRUE(cut);
  EXPECT_EQ(cut->width(), 200);
  EXPECT_EQ(toWindowedCamera(info, CameraModel::kRadtan)->parameters(), cut->parameters());
  const Eigen::Vector3d ray(0.1, -0.2, 1.0);
  Eigen::Vector2d full;
  Eigen::Vector2d binned;
  ASSERT_TRUE(camera.project(ray, &full) && cut->project(ray, &binned));
  // Pixel k of the binned image covers the pixels 2 k and 2 k + 1 of the region.
  EXPECT_NEAR(binned.x(), (full.x() - 100.0 - 0.5) / 2.0, 1e-9);
  EXPECT_NEAR(binned.y(), (full.y() - 60.0 - 0.5) / 2.0, 1e-9);
  const auto back = throughWindow(*cut, *part, *whole);
  ASSERT_TRUE(back);
  EXPECT_LT((back->parameters() - camera.parameters()).norm(), 1e-9);
}

TEST(SensorWindow, RefusesWhatDoesNotFit) {
  sensor_msgs::CameraInfo info = fullInfo();
  info.roi.x_offset = 600;
  info.roi.width = 100;
  info.roi.height = 100;
  EXPECT_FALSE(sensorWindow(info));
  EXPECT_FALSE(toWindowedCamera(info, CameraModel::kFov));
  info.roi.x_offset = 2147483647;  // to which nothing can be added
  EXPECT_FALSE(sensorWindow(info));
  const auto whole = sensorWindow(fullInfo());
  const Camera other = Camera::defaultGuess(CameraModel::kFov, 320, 240);
  EXPECT_FALSE(throughWindow(other, *whole, *whole)) << "a camera of another size";
  SensorWindow other_sensor = *whole;
  other_sensor.full_width = 1280;
  EXPECT_FALSE(throughWindow(*toCamera(fullInfo()), *whole, other_sensor));
}

}  // namespace
}  // namespace camera_self_calibration
