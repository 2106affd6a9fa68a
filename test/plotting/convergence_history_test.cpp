#include "camera_self_calibration/plotting/convergence_history.h"

#include <gtest/gtest.h>

#include "plotting/sample_history.h"

namespace camera_self_calibration {
namespace {

TEST(ConvergenceHistory, KeepsTheWholeRunInBoundedMemory) {
  ConvergenceHistory history(100);
  EXPECT_TRUE(history.empty());
  for (int i = 0; i < 1234; ++i) {
    history.add(sampleReport(CameraModel::kFov, i));
    ASSERT_LE(history.points().size(), 101u);
  }
  const auto points = history.points();
  ASSERT_GE(points.size(), 50u);
  EXPECT_EQ(points.front().seconds, 0.0);
  EXPECT_DOUBLE_EQ(points.back().seconds, 0.25 * 1233) << "the newest is always there";
  EXPECT_EQ(history.latest().revision, 1233u);
  for (std::size_t i = 1; i < points.size(); ++i) {
    EXPECT_GT(points[i].seconds, points[i - 1].seconds);
  }
}

TEST(ConvergenceHistory, ThePointHoldsValuesAndSigmas) {
  ConvergenceHistory history;
  const CalibrationReport report = sampleReport(CameraModel::kFov, 3);
  history.add(report);
  const ConvergencePoint point = history.points().back();
  EXPECT_EQ(point.values, report.camera.parameters());
  EXPECT_DOUBLE_EQ(point.sigmas[0], 1.0);
  EXPECT_DOUBLE_EQ(point.pixel_rms, 1.5);
}

TEST(ConvergenceHistory, WithoutAnEstimateNothingIsKnown) {
  ConvergenceHistory history;
  CalibrationReport report;
  report.camera = Camera::defaultGuess(CameraModel::kRadtan, 640, 480);
  history.add(report);
  const ConvergencePoint point = history.points().back();
  EXPECT_TRUE(std::isnan(point.sigmas[0]));
  EXPECT_TRUE(std::isinf(point.pixel_rms));
}

TEST(ConvergenceHistory, AHeldParameterHasSigmaZero) {
  ConvergenceHistory history;
  CalibrationReport report;
  report.camera = Camera(CameraModel::kRadtan, 640, 480,
                         (Intrinsics(9) << 300, 300, 320, 240, 0, 0, 0, 0, 0.1).finished());
  report.covariance = IntrinsicsMatrix::Identity(8, 8);
  history.add(report);
  EXPECT_EQ(history.points().back().sigmas[7], 1.0);
  EXPECT_EQ(history.points().back().sigmas[8], 0.0);
}

TEST(ConvergenceHistory, TimeGoesOnWhenABagBeginsAgain) {
  ConvergenceHistory history;
  for (int i = 0; i < 40; ++i) history.add(sampleReport(CameraModel::kFov, i));
  const auto span = history.span(2);
  ASSERT_TRUE(span);
  EXPECT_DOUBLE_EQ(span->begin, 1.4);
  for (int i = 0; i < 40; ++i) {
    CalibrationReport again = sampleReport(CameraModel::kFov, i);
    again.queue = sampleReport(CameraModel::kFov, 39).queue;
    history.add(again);
  }
  const auto points = history.points();
  for (std::size_t i = 1; i < points.size(); ++i) {
    ASSERT_GE(points[i].seconds, points[i - 1].seconds);
  }
  EXPECT_DOUBLE_EQ(points.back().seconds, 2 * 0.25 * 39);
  ASSERT_TRUE(history.span(2));
  EXPECT_DOUBLE_EQ(history.span(2)->begin, 1.4) << "where it was recorded, in the first round";
  EXPECT_FALSE(history.span(99));
}

}  // namespace
}  // namespace camera_self_calibration
