#include "camera_self_calibration/plotting/difference_chart.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace camera_self_calibration {
namespace {

Camera radtan(double k1) {
  return Camera(CameraModel::kRadtan, 640, 480,
                (Intrinsics(8) << 420, 420, 320, 240, k1, 0.05, 0, 0).finished());
}

/// Share of the pixels around a place that have this colour.
double shareAround(const cv::Mat& image, int x, int y, const Colour& colour) {
  cv::Mat mask;
  cv::inRange(image(cv::Rect(x - 20, y - 20, 40, 40)), colour - Colour(25, 25, 25),
              colour + Colour(25, 25, 25), mask);
  return cv::countNonZero(mask) / 1600.0;
}

TEST(DifferenceChart, ColoursTellWhereTheDifferenceIsLarge) {
  const PixelDifference difference = pixelDifference(radtan(-0.1), radtan(-0.11));
  const cv::Mat chart = drawDifference(radtan(-0.1), difference).image();
  EXPECT_EQ(chart.cols, 500);
  EXPECT_GT(chart.rows, 400);
  // The image begins at (16, 58): k1 tells at the corners.
  EXPECT_GT(shareAround(chart, 40, 82, errorColour(0.9)), 0.1);
  EXPECT_GT(shareAround(chart, 250, 233, errorColour(0.02)), 0.3);
  EXPECT_LT(shareAround(chart, 250, 233, errorColour(0.9)), 0.02);
}

TEST(DifferenceChart, WhatOneCannotSeeStaysEmpty) {
  const Camera wide(CameraModel::kFov, 640, 480,
                    (Intrinsics(5) << 300, 300, 320, 240, 1.0).finished());
  // Its distortion folds well inside the image.
  const Camera folded(CameraModel::kRadtan, 640, 480,
                      (Intrinsics(8) << 300, 300, 320, 240, -0.5, 0, 0, 0).finished());
  const PixelDifference difference = pixelDifference(wide, folded);
  ASSERT_GT(difference.refused, 100);
  const cv::Mat chart = drawDifference(wide, difference).image();
  EXPECT_GT(shareAround(chart, 40, 82, palette(Theme::kLight).panel), 0.8);
}

TEST(DifferenceChart, EqualCalibrationsAreDrawnToo) {
  const PixelDifference difference = pixelDifference(radtan(-0.1), radtan(-0.1));
  EXPECT_LT(difference.error.max, 1e-9);
  EXPECT_EQ(drawDifference(radtan(-0.1), difference).width(), 500);
}

}  // namespace
}  // namespace camera_self_calibration
