// Images of a smooth function, known at any sub-pixel position.
#include "camera_self_calibration/tracking/lucas_kanade.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "camera_self_calibration/tracking/flow_prediction.h"

namespace camera_self_calibration {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;

double grayAt(double x, double y) {
  return 120.0 + 40.0 * std::sin(0.11 * x + 0.07 * y) + 30.0 * std::sin(0.05 * x - 0.13 * y + 1.0) +
         30.0 * std::sin(0.021 * x + 0.034 * y * y / kHeight);
}

// What moves right and down by `shift`.
ImagePyramid imageOf(const cv::Point2f& shift, double gain) {
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      pixels.push_back(static_cast<std::uint8_t>(
          std::lround(gain * grayAt(static_cast<double>(x) - static_cast<double>(shift.x),
                                    static_cast<double>(y) - static_cast<double>(shift.y)))));
    }
  }
  ImagePyramid pyramid;
  pyramid.build({nullptr, pixels.data(), kWidth, kHeight, kWidth, 0});
  return pyramid;
}

TEST(LucasKanade, FindsTheShiftOnOneLevel) {
  const cv::Point2f shift(1.3f, -0.7f);
  const ImagePyramid from = imageOf({}, 1.0), to = imageOf(shift, 1.0);
  LucasKanade lucas_kanade;
  for (float y = 20.25f; y < 220.0f; y += 40.0f) {
    for (float x = 20.5f; x < 300.0f; x += 40.0f) {
      cv::Point2f position(x, y);
      ASSERT_TRUE(lucas_kanade.follow(from, 1.0f, {x, y}, to, {0, 10, 0.005f}, &position));
      EXPECT_NEAR(position.x, x + shift.x, 0.06) << x << ", " << y;
      EXPECT_NEAR(position.y, y + shift.y, 0.06) << x << ", " << y;
    }
  }
}

TEST(LucasKanade, KnowsTheBrightness) {
  const cv::Point2f shift(0.8f, 0.6f);
  const ImagePyramid from = imageOf({}, 1.0), to = imageOf(shift, 0.6);
  LucasKanade lucas_kanade;
  cv::Point2f position(150.0f, 100.0f);
  ASSERT_TRUE(lucas_kanade.follow(from, 0.6f, {150.0f, 100.0f}, to, {0, 10, 0.005f}, &position));
  EXPECT_NEAR(position.x, 150.8, 0.05);
  EXPECT_NEAR(position.y, 100.6, 0.05);
}

TEST(LucasKanade, RefusesWhatHasNoTextureOrLeavesTheImage) {
  const std::vector<std::uint8_t> gray(kWidth * kHeight, 128);
  ImagePyramid blank;
  blank.build({nullptr, gray.data(), kWidth, kHeight, kWidth, 0});
  LucasKanade lucas_kanade;
  cv::Point2f position(100.0f, 100.0f);
  EXPECT_FALSE(lucas_kanade.follow(blank, 1.0f, {100.0f, 100.0f}, blank, {}, &position));

  const ImagePyramid image = imageOf({}, 1.0);
  for (const cv::Point2f& guess : {cv::Point2f(-30.0f, 100.0f), cv::Point2f(100.0f, 400.0f),
                                   cv::Point2f(std::nanf(""), 100.0f)}) {
    position = guess;
    EXPECT_FALSE(lucas_kanade.follow(image, 1.0f, {100.0f, 100.0f}, image, {}, &position)) << guess;
  }
}

// Points at the very edge are read in the border, not beyond it.
TEST(LucasKanade, ReadsUpToTheEdge) {
  const ImagePyramid image = imageOf({}, 1.0);
  LucasKanade lucas_kanade;
  for (const cv::Point2f& point : {cv::Point2f(0.0f, 0.0f), cv::Point2f(kWidth - 1, kHeight - 1)}) {
    cv::Point2f position = point;
    LucasKanade::Effort effort;
    effort.coarsest_level = image.levels() - 1;
    EXPECT_TRUE(lucas_kanade.follow(image, 1.0f, point, image, effort, &position));
    EXPECT_NEAR(position.x, point.x, 0.05);
    EXPECT_NEAR(position.y, point.y, 0.05);
  }
}

// Far beyond the reach of the two finest levels: the scouts find it for all.
TEST(FlowPrediction, ScoutsBridgeALargeShift) {
  const cv::Point2f shift(14.0f, -9.0f);
  const ImagePyramid from = imageOf({}, 1.0), to = imageOf(shift, 1.0);
  std::vector<cv::Point2f> points;
  for (float y = 60.0f; y < 200.0f; y += 15.0f) {
    for (float x = 60.0f; x < 260.0f; x += 15.0f) points.emplace_back(x, y);
  }
  std::vector<cv::Point2f> predicted = points;
  FlowPrediction flow;
  flow.run(from, to, points, &predicted);
  int found = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!flow.found(i)) continue;
    const cv::Point2f error = predicted[i] - points[i] - shift;
    found += error.dot(error) < 0.1f * 0.1f;
  }
  EXPECT_GT(found, static_cast<int>(0.9 * static_cast<double>(points.size())));
}

}  // namespace
}  // namespace camera_self_calibration
