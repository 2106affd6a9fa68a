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

TEST(Sheet, ItsSvgHoldsTheSameShapes) {
  const Palette& light = palette(Theme::kLight);
  Sheet sheet(60, 40, light.background);
  sheet.fill({10, 10, 5, 5}, light.panel);
  sheet.curve({{-1e9, 20.0}, {30.0, 20.126}}, kRed, 2.0, {20, 10, 20, 20}, true);
  sheet.text("a < b & c", {5.0, 30.0}, 7.2, light.text, Align::kRight, true);
  EXPECT_EQ(sheet.svg("what \"it\" is"),
            "<svg viewBox=\"0 0 60 40\" role=\"img\" aria-label=\"what &quot;it&quot; is\">"
            "<rect x=\"10\" y=\"10\" width=\"5\" height=\"5\" style=\"fill:var(--panel)\"/>"
            "<svg x=\"20\" y=\"10\" width=\"20\" height=\"20\" viewBox=\"20 10 20 20\">"
            "<polyline points=\"-100000,20 30,20.13\" style=\"fill:none;stroke:rgb(255,0,0)\" "
            "stroke-width=\"2\" stroke-dasharray=\"5\"/></svg>"
            "<text x=\"5\" y=\"30\" font-size=\"10\" style=\"fill:var(--text)\" "
            "text-anchor=\"end\" font-weight=\"bold\">a &lt; b &amp; c</text></svg>");
}

TEST(Sheet, ATransparentFillMixesWithWhatIsBelow) {
  Sheet sheet(60, 40, kWhite);
  sheet.fill({10, 10, 5, 5}, kRed, 0.4);
  EXPECT_EQ(at(sheet, 12, 12), cv::Vec3b(153, 153, 255));
  EXPECT_NE(sheet.svg("").find("fill-opacity=\"0.4\""), std::string::npos);
}

TEST(Palette, TheStyleSheetNamesEveryColourOfATheme) {
  const std::string light = paletteCss(Theme::kLight);
  EXPECT_NE(light.find("--background:rgb(255,255,255);"), std::string::npos) << light;
  EXPECT_NE(light.find("--faint-text:"), std::string::npos) << light;
  EXPECT_NE(light, paletteCss(Theme::kDark));
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
