// rectify_demo.launch: what image_proc makes of the live calibration, held against the true lens.

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/Header.h>

#include <cmath>
#include <optional>

#include "camera_self_calibration/ros/camera_info.h"
#include "ros/recorder.h"

namespace camera_self_calibration {
namespace {

template <typename Message>
typename Message::ConstPtr withStamp(const Recorder<Message>& recorder, const ros::Time& stamp) {
  for (const auto& message : recorder.messages) {
    if (message->header.stamp == stamp) return message;
  }
  return nullptr;
}

/// Bilinear; nothing outside the image.
std::optional<double> grayAt(const sensor_msgs::Image& image, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::floor(pixel.x()));
  const int y = static_cast<int>(std::floor(pixel.y()));
  if (x < 0 || y < 0 || x + 1 >= int(image.width) || y + 1 >= int(image.height)) return {};
  const auto at = [&](int column, int row) {
    return double(image.data[std::size_t(row) * image.step + std::size_t(column)]);
  };
  const double u = pixel.x() - x;
  const double v = pixel.y() - y;
  return (1 - v) * ((1 - u) * at(x, y) + u * at(x + 1, y)) +
         v * ((1 - u) * at(x, y + 1) + u * at(x + 1, y + 1));
}

/// Mean difference [gray] between a rectified image and the raw one seen through `lens`.
double differenceThrough(const Camera& lens, const sensor_msgs::Image& raw,
                         const sensor_msgs::Image& rectified, const sensor_msgs::CameraInfo& info) {
  double sum = 0.0;
  int count = 0;
  for (int y = 4; y < int(rectified.height) - 4; y += 3) {
    for (int x = 4; x < int(rectified.width) - 4; x += 3) {
      const Eigen::Vector3d ray((x - info.P[2]) / info.P[0], (y - info.P[6]) / info.P[5], 1.0);
      Eigen::Vector2d pixel;
      if (!lens.project(ray, &pixel)) continue;
      const auto expected = grayAt(raw, pixel);
      if (!expected) continue;
      const auto found = rectified.data[std::size_t(y) * rectified.step + std::size_t(x)];
      sum += std::abs(found - *expected);
      ++count;
    }
  }
  return count > 10000 ? sum / count : 1e9;
}

TEST(RectifyDemo, ImagesAreRectifiedAsByTheTrueLens) {
  const Recorder<sensor_msgs::Image> raw("/selfcal/image_raw");
  const Recorder<sensor_msgs::CameraInfo> info("/selfcal/camera_info");
  const Recorder<sensor_msgs::CameraInfo> truth("/simulated_camera/truth/camera_info");
  const Recorder<sensor_msgs::Image> rectified("/selfcal/image_rect");
  const Recorder<std_msgs::Header> finished("/simulated_camera/truth/finished");
  ASSERT_TRUE(spinUntil([&] { return !finished.messages.empty(); }, 90.0));
  spinUntil([] { return false; }, 1.0);
  ASSERT_GT(rectified.messages.size(), 20u);
  ASSERT_FALSE(truth.messages.empty());

  const sensor_msgs::Image& last = *rectified.messages.back();
  const auto same_raw = withStamp(raw, last.header.stamp);
  const auto same_info = withStamp(info, last.header.stamp);
  ASSERT_TRUE(same_raw && same_info) << "rectified images keep their stamps";
  ASSERT_EQ(last.encoding, "mono8");
  const std::optional<Camera> lens = toCamera(*truth.messages.back());
  ASSERT_TRUE(lens);
  EXPECT_LT(differenceThrough(*lens, *same_raw, last, *same_info), 2.0);

  // The check can fail: without distortion nothing fits.
  const Camera straight(CameraModel::kPinhole, lens->width(), lens->height(),
                        lens->parameters().head(4));
  EXPECT_GT(differenceThrough(straight, *same_raw, last, *same_info), 6.0);
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "rectify_demo_test");
  ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
