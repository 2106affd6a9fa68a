#include "camera_self_calibration/plotting/convergence_chart.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "plotting/sample_history.h"

namespace camera_self_calibration {
namespace {

/// Pixels of exactly this colour.
int count(const cv::Mat& image, const Colour& colour) {
  cv::Mat mask;
  cv::inRange(image, colour - Colour(1, 1, 1), colour + Colour(1, 1, 1), mask);
  return cv::countNonZero(mask);
}

TEST(ConvergenceChart, ShowsCurveBandAndStateForEveryModel) {
  for (const CameraModel model : {CameraModel::kPinhole, CameraModel::kFov, CameraModel::kRadtan,
                                  CameraModel::kEquidistant}) {
    for (const Theme theme : {Theme::kLight, Theme::kDark}) {
      ConvergenceStyle style;
      style.theme = theme;
      const cv::Mat chart = drawConvergence(sampleHistory(model, 60), style);
      EXPECT_EQ(chart.size(), cv::Size(style.width, style.height));
      EXPECT_GT(count(chart, palette(theme).band), 3000) << toString(model);
      EXPECT_GT(count(chart, palette(theme).curve), 100) << toString(model);
      EXPECT_GT(count(chart, stateColour(CalibrationState::kConverged)), 500);
      EXPECT_GT(count(chart, stateColour(CalibrationState::kInitializing)), 50) << "the strip";
      EXPECT_GT(count(chart, scoreColour(0.0)), 20) << "the best segment";
      EXPECT_GT(count(chart, scoreColour(1.0)), 20) << "the worst segment";
    }
  }
}

/// Rows of the first panel that the band covers in the column of an image, as (first, last).
std::pair<int, int> bandRows(const cv::Mat& chart, int column, const Colour& colour) {
  std::pair<int, int> rows = {-1, -1};
  for (int y = 0; y < 228; ++y) {
    const auto& pixel = chart.at<cv::Vec3b>(y, column);
    if (cv::norm(Colour(pixel[0], pixel[1], pixel[2]) - colour) > 2.0) continue;
    if (rows.first < 0) rows.first = y;
    rows.second = y;
  }
  return rows;
}

/// The band's height in fx's panel, if fx has the sigma given and is known to be 10 px larger.
int bandHeight(double sigma) {
  ConvergenceHistory history;
  for (int i = 0; i < 50; ++i) {
    CalibrationReport report = sampleReport(CameraModel::kPinhole, i);
    report.camera = Camera::defaultGuess(CameraModel::kPinhole, 640, 480);
    report.covariance = sigma * sigma * IntrinsicsMatrix::Identity(4, 4);
    history.add(report);
  }
  ConvergenceStyle style;
  style.height = 1000;
  Camera truth = Camera::defaultGuess(CameraModel::kPinhole, 640, 480);
  truth.setParameters((truth.parameters().array() + 10.0).matrix());
  style.truth = truth;
  const auto rows = bandRows(drawConvergence(history, style), 430, palette(style.theme).band);
  return rows.second - rows.first;
}

TEST(ConvergenceChart, TheBandIsThreeSigmaWide) {
  // The known value holds the scale, so that the height grows with sigma alone.
  const int one = bandHeight(1.0);
  EXPECT_GT(one, 20);
  EXPECT_NEAR(bandHeight(2.0), 2 * one, 3);
  EXPECT_NEAR(bandHeight(0.5), one / 2, 3);
}

TEST(ConvergenceChart, AKnownCalibrationIsDashed) {
  ConvergenceStyle style;
  const ConvergenceHistory history = sampleHistory(CameraModel::kFov, 60);
  EXPECT_EQ(count(drawConvergence(history, style), palette(style.theme).truth), 0);
  style.truth = history.latest().camera;
  EXPECT_GT(count(drawConvergence(history, style), palette(style.theme).truth), 200);
}

TEST(ConvergenceChart, IsDrawnWithLittleOrNothingKnown) {
  EXPECT_EQ(drawConvergence(ConvergenceHistory(), {}).size(), cv::Size(760, 720));
  ConvergenceHistory history;
  CalibrationReport report;
  report.camera = Camera::defaultGuess(CameraModel::kFov, 640, 480);
  history.add(report);
  ConvergenceStyle style;
  style.width = 10;
  const cv::Mat chart = drawConvergence(history, style);
  EXPECT_EQ(chart.cols, 400);
  EXPECT_EQ(count(chart, palette(style.theme).band), 0) << "no band without an estimate";
}

TEST(ConvergenceChart, SurvivesWildValues) {
  ConvergenceHistory history;
  for (int i = 0; i < 20; ++i) {
    CalibrationReport report = sampleReport(CameraModel::kRadtan, i);
    report.covariance *= i % 3 == 0 ? 1e30 : 1e-30;
    report.uncertainty.rms = i % 4 == 0 ? 1e30 : 0.0;
    history.add(report);
  }
  EXPECT_EQ(drawConvergence(history, {}).cols, 760);
}

TEST(ConvergenceChart, ChecksAreSaidInWords) {
  CalibrationReport report;
  EXPECT_EQ(checksInWords(report), "");
  report.cross_validation.compared = true;
  report.lens_fit.compared = true;
  report.observed.share = 0.96;
  EXPECT_EQ(checksInWords(report),
            "halves of the video agree, lens model fits, features in 96 % of the image");
  report.cross_validation.p_value = 1e-9;
  report.lens_fit.refuted = true;
  EXPECT_EQ(checksInWords(report),
            "halves of the video disagree, lens model does not fit, features in 96 % of the image");
}

TEST(ConvergenceChart, ScoresGoFromTheBestToTheWorst) {
  const QueueReport queue = sampleReport(CameraModel::kFov, 59).queue;
  EXPECT_EQ(scoreShare(queue.segments.front(), queue), 0.0);
  EXPECT_EQ(scoreShare(queue.segments.back(), queue), 1.0);
  EXPECT_EQ(scoreShare(queue.segments.front(), QueueReport()), 0.0);
}

}  // namespace
}  // namespace camera_self_calibration
