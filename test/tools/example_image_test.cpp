#include "camera_self_calibration/tools/example_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

namespace camera_self_calibration {
namespace {

Camera camera(CameraModel model, const Intrinsics& parameters) {
  return Camera(model, 640, 480, parameters);
}

const Camera kPinhole =
    camera(CameraModel::kPinhole, (Intrinsics(4) << 320.0, 320.0, 319.5, 239.5).finished());

TEST(Undistorted, APinholeImageStaysAsItIs) {
  cv::Mat gray(480, 640, CV_8UC1);
  cv::randu(gray, 0, 255);
  const cv::Mat result = undistorted(gray, kPinhole);
  ASSERT_EQ(result.size(), gray.size());
  EXPECT_LT(cv::norm(result, gray, cv::NORM_L1) / 640.0 / 480.0, 1.0);
}

TEST(Undistorted, WhatTheLensDidNotSeeIsBlack) {
  const Camera fov =
      camera(CameraModel::kFov, (Intrinsics(5) << 320, 320, 319.5, 239.5, 1.0).finished());
  const cv::Mat result = undistorted(cv::Mat(480, 640, CV_8UC1, cv::Scalar(200)), fov);
  EXPECT_EQ(result.at<std::uint8_t>(240, 320), 200);
  EXPECT_EQ(result.at<std::uint8_t>(0, 320), 0);
  EXPECT_TRUE(undistorted(cv::Mat(), fov).empty());
}

// As of a region of interest at the border of a sensor.
TEST(Undistorted, ShowsWhatLiesOnOneSideOfTheAxis) {
  const Camera beside =
      camera(CameraModel::kPinhole, (Intrinsics(4) << 320.0, 320.0, -320.0, 239.5).finished());
  const cv::Mat result = undistorted(cv::Mat(480, 640, CV_8UC1, cv::Scalar(200)), beside);
  for (const int column : {200, 320, 440}) EXPECT_EQ(result.at<std::uint8_t>(240, column), 200);
}

TEST(ExampleFinder, KeepsTheImageWithMostTracksOfThePresentLens) {
  ExampleFinder finder;
  const std::vector<std::uint8_t> pixels(64, 7);
  const auto add = [&](std::int64_t stamp_ns, int tracks, std::uint64_t epoch) {
    ImageView image;
    image.data = pixels.data();
    image.width = image.height = image.stride = 8;
    image.stamp_ns = stamp_ns;
    FrameResult frame;
    for (int i = 0; i < tracks; ++i) {
      frame.tracks.tracks.emplace_back();
      frame.tracks.tracks.back().id = i;
    }
    finder.add(image, frame, epoch);
  };
  add(1, 0, 0);
  EXPECT_TRUE(finder.found().gray.empty());
  add(2, 5, 0);
  add(3, 4, 0);
  EXPECT_EQ(finder.found().stamp_ns, 2);
  add(4, 3, 1);
  EXPECT_EQ(finder.found().stamp_ns, 4) << "the lens changed";
  EXPECT_EQ(finder.found().trails.trails().size(), 3u);
  EXPECT_EQ(finder.found().gray.at<std::uint8_t>(3, 3), 7);
}

}  // namespace
}  // namespace camera_self_calibration
