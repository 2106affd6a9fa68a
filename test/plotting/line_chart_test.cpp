#include "camera_self_calibration/plotting/line_chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "camera_self_calibration/plotting/contribution_chart.h"
#include "camera_self_calibration/plotting/histogram.h"
#include "camera_self_calibration/plotting/image_map.h"
#include "camera_self_calibration/plotting/trajectory_chart.h"

namespace camera_self_calibration {
namespace {

const Colour kInk(10, 120, 250);

bool near(const cv::Vec3b& pixel, const Colour& colour) {
  double distance = 0.0;
  for (int c = 0; c < 3; ++c) distance += std::abs(pixel[c] - colour[c]);
  return distance < 40.0;
}

int pixelsOf(const cv::Mat& image, const Colour& colour) {
  int count = 0;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) count += near(image.at<cv::Vec3b>(y, x), colour);
  }
  return count;
}

LineChart someChart() {
  Curve curve{"curve", kInk, false, {}, {}, {}};
  for (int i = 0; i < 200; ++i) {
    curve.x.push_back(i);
    curve.y.push_back(5.0 + std::sin(0.1 * i));
  }
  LineChart chart;
  chart.curves = {curve};
  return chart;
}

TEST(LineChart, DrawsItsCurvesAndTwiceAsManyPixelsIfFine) {
  LineChartSheet sheet;
  sheet.width = 500;
  const cv::Mat image = drawLineCharts({someChart(), someChart(), someChart()}, sheet).image();
  EXPECT_EQ(image.cols, 500);
  EXPECT_GT(pixelsOf(image, kInk), 300);
  const cv::Mat fine = drawLineCharts({someChart(), someChart(), someChart()}, sheet).fineImage();
  EXPECT_EQ(fine.cols, 2 * image.cols);
  EXPECT_EQ(fine.rows, 2 * image.rows);
}

TEST(LineChart, WhatIsNotANumberLeavesAGap) {
  LineChart chart = someChart();
  LineChartSheet sheet;
  const int whole = pixelsOf(drawLineCharts({chart}, sheet).image(), kInk);
  for (double& y : chart.curves[0].y) y = NAN;
  // Only the legend is left.
  EXPECT_LT(pixelsOf(drawLineCharts({chart}, sheet).image(), kInk), whole / 4);
  chart.curves.clear();
  EXPECT_FALSE(drawLineCharts({chart}, sheet).image().empty());
  EXPECT_FALSE(drawLineCharts({}, sheet).image().empty());
}

TEST(LineChart, WildBeginningsAreCutOff) {
  LineChart chart = someChart();
  chart.curves[0].y[0] = 1e9;
  EXPECT_GT(pixelsOf(drawLineCharts({chart}, LineChartSheet()).image(), kInk), 300);
}

TEST(ImageMap, ColoursTheLargestValueAndLeavesNothingGrey) {
  ImageMap map;
  map.image_width = 640;
  map.image_height = 480;
  map.values = Eigen::MatrixXd::Constant(3, 4, NAN);
  map.values(0, 0) = 2.0;
  map.values(2, 3) = 1.0;
  const cv::Mat image = drawImageMap(map, 400).image();
  ASSERT_EQ(image.cols, 400);
  EXPECT_TRUE(near(image.at<cv::Vec3b>(60, 50), errorColour(1.0)));
  EXPECT_TRUE(near(image.at<cv::Vec3b>(270, 350), errorColour(0.5)));
  EXPECT_TRUE(near(image.at<cv::Vec3b>(60, 350), palette(Theme::kLight).grid));
}

TEST(Histogram, ToleratesNothingAndFarValues) {
  EXPECT_FALSE(drawResidualHistogram({}, "", 400, 300).image().empty());
  const std::vector<WhitenedResidual> residuals = {
      {0.0, 1.0}, {100.0, 0.0}, {-1e9, 1.0}, {NAN, 1.0}};
  EXPECT_EQ(drawResidualHistogram(residuals, "", 400, 300).image().cols, 400);
}

TEST(Paths, AreDrawnWithEqualScales) {
  PlanePath path;
  path.colour = kInk;
  for (int i = 0; i <= 100; ++i)
    path.points.emplace_back(std::cos(0.0628 * i), std::sin(0.0628 * i));
  const cv::Mat image = drawPaths({path}, "circle", "m", 700, 400).image();
  int left = image.cols, right = 0, top = image.rows, bottom = 0;
  for (int y = 50; y < image.rows - 45; ++y) {
    for (int x = 60; x < image.cols - 20; ++x) {
      if (!near(image.at<cv::Vec3b>(y, x), kInk)) continue;
      left = std::min(left, x);
      right = std::max(right, x);
      top = std::min(top, y);
      bottom = std::max(bottom, y);
    }
  }
  EXPECT_NEAR(right - left, bottom - top, 10);
  EXPECT_GT(right - left, 150);
}

TEST(Teachings, ASegmentTeachesWhatOnlyItKnows) {
  Intrinsics values(4);
  values << 300.0, 300.0, 320.0, 240.0;
  const Camera camera(CameraModel::kPinhole, 640, 480, values);
  std::vector<Candidate> queue(3);
  for (int s = 0; s < 3; ++s) {
    Candidate& candidate = queue[static_cast<std::size_t>(s)];
    candidate.segment.keyframes.resize(2);
    candidate.segment.keyframes[0].stamp_ns = 1000000000LL * (10 + 4 * s);
    candidate.segment.keyframes[1].stamp_ns = 1000000000LL * (12 + 4 * s);
    candidate.information = IntrinsicsMatrix::Identity(4, 4);
    if (s == 1) candidate.information(2, 2) = 100.0;
  }
  const std::vector<SegmentContribution> contributed = contributions(queue, camera, 10000000000LL);
  ASSERT_EQ(contributed.size(), 3u);
  EXPECT_NEAR(contributed[1].begin_s, 4.0, 1e-9);
  EXPECT_NEAR(contributed[1].end_s, 6.0, 1e-9);
  EXPECT_NEAR(contributed[0].values[0], std::sqrt(3.0 / 2.0) - 1.0, 1e-6);
  EXPECT_NEAR(contributed[1].values[2], std::sqrt(102.0 / 2.0) - 1.0, 1e-6);
  EXPECT_GT(contributed[1].image, contributed[0].image);
  EXPECT_FALSE(drawContributions(contributed, camera.parameterNames(), 20.0, 600).image().empty());
  queue.resize(1);
  EXPECT_TRUE(std::isinf(contributions(queue, camera, 0)[0].image));
}

}  // namespace
}  // namespace camera_self_calibration
