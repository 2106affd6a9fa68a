// image_proc/rectify with our CameraInfo, for every camera model: the rectified image of a known
// pattern is that pattern, seen without a lens.

#include <gtest/gtest.h>
#include <image_geometry/pinhole_camera_model.h>
#include <image_transport/image_transport.h>
#include <nodelet/NodeletList.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/ros/camera_info.h"
#include "ros/recorder.h"

namespace camera_self_calibration {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr double kWaves = 2.0 * M_PI / 0.15;  // Per unit of the plane one in front of the camera.

/// Gray value of the pattern that is painted on the plane z = 1.
double pattern(double x, double y) {
  return 128.0 + 50.0 * std::sin(kWaves * x) + 50.0 * std::sin(kWaves * y);
}

sensor_msgs::Image rawImage(const Camera& camera) {
  sensor_msgs::Image image;
  image.encoding = "mono8";
  image.width = kWidth;
  image.height = kHeight;
  image.step = kWidth;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const auto ray = camera.unproject({u, v});
      const double gray = ray ? pattern(ray->x() / ray->z(), ray->y() / ray->z()) : 0.0;
      image.data.push_back(static_cast<std::uint8_t>(std::lround(gray)));
    }
  }
  return image;
}

/// By how much a square of the rectified image is shifted against the pattern [px]: least squares
/// over gray values and the pattern's gradient. P is that of the CameraInfo.
Eigen::Vector2d shiftOf(const sensor_msgs::Image& image, const boost::array<double, 12>& p,
                        int left, int top, int size) {
  Eigen::Matrix2d h = Eigen::Matrix2d::Zero();
  Eigen::Vector2d g = Eigen::Vector2d::Zero();
  for (int v = top; v < top + size; ++v) {
    for (int u = left; u < left + size; ++u) {
      const double x = (u - p[2]) / p[0];
      const double y = (v - p[6]) / p[5];
      const Eigen::Vector2d gradient(50.0 * kWaves / p[0] * std::cos(kWaves * x),
                                     50.0 * kWaves / p[5] * std::cos(kWaves * y));
      const std::size_t at = static_cast<std::size_t>(v) * image.step + static_cast<std::size_t>(u);
      h += gradient * gradient.transpose();
      g += gradient * (pattern(x, y) - image.data[at]);
    }
  }
  return h.ldlt().solve(g);
}

/// The largest shift over the image [px]; squares whose pixels lie outside the raw image are left
/// out. `squares` counts the others.
double largestShift(const sensor_msgs::Image& image, const sensor_msgs::CameraInfo& info,
                    int* squares) {
  image_geometry::PinholeCameraModel model;
  model.fromCameraInfo(info);
  constexpr int kSize = 80;
  double largest = 0.0;
  *squares = 0;
  for (int top = 0; top < kHeight; top += kSize) {
    for (int left = 0; left < kWidth; left += kSize) {
      bool seen = true;
      for (int i = 0; i < 4; ++i) {
        const cv::Point2d raw =
            model.unrectifyPoint(cv::Point2d(left + (i & 1) * kSize, top + (i >> 1) * kSize));
        seen = seen && raw.x > 2 && raw.y > 2 && raw.x < kWidth - 3 && raw.y < kHeight - 3;
      }
      if (!seen) continue;
      ++*squares;
      largest = std::max(largest, shiftOf(image, info.P, left, top, kSize).norm());
    }
  }
  return largest;
}

class Rectify : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(spinUntil([this] { return rectified_.connected(); }, 20.0));
    ASSERT_TRUE(spinUntil([this] { return publisher_.getNumSubscribers() > 0; }, 20.0));
  }

  /// What image_proc makes of it; null if nothing comes within the limit.
  sensor_msgs::ImageConstPtr rectify(sensor_msgs::Image image, sensor_msgs::CameraInfo info,
                                     double limit_s = 10.0) {
    image.header.stamp = ros::Time(++seconds_, 0);
    image.header.frame_id = "camera";
    info.header = image.header;
    const std::size_t before = rectified_.messages.size();
    publisher_.publish(image, info);
    spinUntil([&] { return rectified_.messages.size() > before; }, limit_s);
    return rectified_.messages.size() > before ? rectified_.messages.back() : nullptr;
  }

  ros::NodeHandle node_;
  Recorder<sensor_msgs::Image> rectified_{"/camera/image_rect"};
  image_transport::ImageTransport transport_{node_};
  image_transport::CameraPublisher publisher_ = transport_.advertiseCamera("/camera/image_raw", 5);
  static std::uint32_t seconds_;
};
std::uint32_t Rectify::seconds_ = 100;

TEST_F(Rectify, TheLensIsGoneForEveryCameraModel) {
  struct Case {
    Camera camera;
    OutputModel output;
  };
  const Camera fov = camera640(CameraModel::kFov, {311.2, 309.8, 327.4, 233.1, 0.93});
  const Camera radtan =
      camera640(CameraModel::kRadtan, {420, 421, 325, 245, -0.25, 0.06, 4e-4, -6e-4});
  const Camera equidistant =
      camera640(CameraModel::kEquidistant, {300, 301, 325, 236, -0.03, 0.004, 0.001, 0.0});
  for (const Case& c :
       {Case{camera640(CameraModel::kPinhole, {500, 510, 327, 233}), OutputModel::kAuto},
        Case{radtan, OutputModel::kAuto}, Case{equidistant, OutputModel::kAuto},
        Case{fov, OutputModel::kAuto}, Case{fov, OutputModel::kRationalPolynomial},
        Case{radtan, OutputModel::kRationalPolynomial}}) {
    const auto conversion = toCameraInfo(c.camera, c.output);
    ASSERT_TRUE(conversion);
    const auto image = rectify(rawImage(c.camera), conversion->info);
    ASSERT_TRUE(image) << describe(c.camera);
    int squares = 0;
    const double shift = largestShift(*image, conversion->info, &squares);
    std::cout << conversion->info.distortion_model << " of " << describe(c.camera) << ": " << shift
              << " px in the worst of " << squares << " squares\n";
    EXPECT_GE(squares, 24) << describe(c.camera);
    EXPECT_LT(shift, 0.05) << describe(c.camera);
  }
}

TEST_F(Rectify, AFixedProjectionKeepsTheRectifiedGeometry) {
  const Camera lens = camera640(CameraModel::kFov, {311.2, 309.8, 327.4, 233.1, 0.93});
  sensor_msgs::CameraInfo info = toCameraInfo(lens)->info;
  info.P[0] = info.P[5] = 280.0;
  info.P[2] = 319.5;
  info.P[6] = 239.5;
  const auto image = rectify(rawImage(lens), info);
  ASSERT_TRUE(image);
  int squares = 0;
  EXPECT_LT(largestShift(*image, info, &squares), 0.05);
  EXPECT_GE(squares, 30);
}

TEST_F(Rectify, ZerosRectifyNothingAndHarmNothing) {
  const Camera lens = camera640(CameraModel::kPinhole, {500, 510, 327, 233});
  EXPECT_FALSE(rectify(rawImage(lens), uncalibratedCameraInfo(kWidth, kHeight), 1.0));
  EXPECT_TRUE(rectify(rawImage(lens), toCameraInfo(lens)->info));
  nodelet::NodeletList list;
  ASSERT_TRUE(ros::service::call("/manager/list", list)) << "the manager died";
  EXPECT_EQ(list.response.nodelets.size(), 1u);
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "rectify_test");
  ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
