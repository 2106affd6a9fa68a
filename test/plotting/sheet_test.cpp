#include "camera_self_calibration/plotting/sheet.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace camera_self_calibration {
namespace {

const Colour kWhite = {255, 255, 255};
const Colour kRed = {0, 0, 255};

cv::Vec3b at(const Sheet& sheet, int x, int y) { return sheet.image().at<cv::Vec3b>(y, x); }

TEST(Sheet, HasTheSizeAndTheBackgroundGiven) {
  const Sheet sheet(60, 40, kWhite);
  EXPECT_EQ(sheet.image().size(), cv::Size(60, 40));
  EXPECT_EQ(sheet.image().type(), CV_8UC3);
  EXPECT_EQ(at(sheet, 30, 20), cv::Vec3b(255, 255, 255));
}

TEST(Sheet, FillsExactlyTheArea) {
  Sheet sheet(60, 40, kWhite);
  sheet.fill({10, 10, 5, 5}, kRed);
  EXPECT_EQ(at(sheet, 10, 10), cv::Vec3b(0, 0, 255));
  EXPECT_EQ(at(sheet, 14, 14), cv::Vec3b(0, 0, 255));
  EXPECT_EQ(at(sheet, 9, 12), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(at(sheet, 15, 12), cv::Vec3b(255, 255, 255));
}

TEST(Sheet, CurvesAndPolygonsEndAtTheirArea) {
  Sheet sheet(60, 40, kWhite);
  sheet.curve({{-1e9, 20.0}, {1e9, 20.0}}, kRed, 2.0, {20, 10, 20, 20});
  EXPECT_NE(at(sheet, 30, 20), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(at(sheet, 18, 20), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(at(sheet, 42, 20), cv::Vec3b(255, 255, 255));
  sheet.polygon({{0, 0}, {60, 0}, {60, 40}, {0, 40}}, kRed, {50, 30, 5, 5});
  EXPECT_EQ(at(sheet, 52, 32), cv::Vec3b(0, 0, 255));
  EXPECT_EQ(at(sheet, 48, 32), cv::Vec3b(255, 255, 255));
}

TEST(Sheet, AnAreaOutsideDrawsNothing) {
  Sheet sheet(60, 40, kWhite);
  sheet.curve({{100.0, 100.0}, {120.0, 120.0}}, kRed, 1.0, {100, 100, 20, 20});
  sheet.fill({100, 100, 10, 10}, kRed);
  EXPECT_EQ(cv::norm(sheet.image(), cv::Mat(40, 60, CV_8UC3, kWhite), cv::NORM_INF), 0.0);
}

TEST(Sheet, TextStandsWhereItIsAnchored) {
  Sheet sheet(200, 40, kWhite);
  sheet.text("fx 1 \u00b1 2", {100.0, 30.0}, 10.0, {0, 0, 0}, Align::kRight);
  const cv::Mat image = sheet.image();
  const double width = Sheet::textWidth("fx 1 \u00b1 2", 10.0);
  EXPECT_GT(width, 30.0);
  EXPECT_LT(cv::mean(image.colRange(int(100 - width), 100))[0], 245.0);
  EXPECT_EQ(cv::mean(image.colRange(105, 200))[0], 255.0);
  EXPECT_EQ(cv::mean(image.colRange(0, int(95 - width)))[0], 255.0);
}

TEST(Palette, ScoresDifferInLightness) {
  double last = 256.0;
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const Colour c = scoreColour(share);
    const double lightness = 0.1 * c[0] + 0.6 * c[1] + 0.3 * c[2];
    EXPECT_LT(lightness, last - 10.0);
    last = lightness;
  }
  EXPECT_EQ(scoreColour(-3.0), scoreColour(0.0));
  EXPECT_EQ(scoreColour(7.0), scoreColour(1.0));
}

}  // namespace
}  // namespace camera_self_calibration
