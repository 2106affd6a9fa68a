#include <gtest/gtest.h>

#include <iostream>

#include "estimation/sample_segments.h"
#include "pipeline/track_run.h"
#include "sanitized.h"

namespace camera_self_calibration {
namespace {

TEST(Refusal, AStillCameraWaitsForMotion) {
  const Camera truth = ordinaryCameras()[1];
  TrackRunOptions run;
  run.motion = MotionKind::kStill;
  TrackRun calibration(truth, optionsFor(truth.model()), run);
  calibration.run(150);
  EXPECT_EQ(calibration.report().state, CalibrationState::kWaitingForMotion);
  EXPECT_EQ(calibration.record.reports.size(), 1u);  // the first frame's
  EXPECT_FALSE(calibration.report().hint.empty());
  EXPECT_EQ(calibration.record.frames.back().state, TrackingState::kTracking);
  EXPECT_TRUE(calibration.record.events.empty());
}

TEST(Refusal, TranslationAloneNeverConverges) {
  for (const MotionKind motion : {MotionKind::kSidewaysOnly, MotionKind::kForwardOnly}) {
    const bool sideways = motion == MotionKind::kSidewaysOnly;
    for (const int c : sideways ? std::vector<int>{1, 2} : std::vector<int>{0, 3}) {
      if (kSanitized && c > 1) continue;
      const Camera truth = ordinaryCameras()[c];
      TrackRunOptions run;
      run.motion = motion;
      run.motion_speed = 1.5;
      run.rate_hz = 8.0;
      run.seed = 10 + c;
      TrackRun calibration(truth, optionsFor(truth.model()), run);
      calibration.run(140);
      const CalibrationReport report = calibration.report();
      std::cout << toString(motion) << " " << toString(truth.model()) << ": "
                << toString(report.state) << " after " << report.keyframes
                << " keyframes: " << report.sentence << "\n";
      EXPECT_GE(report.keyframes, 12);
      EXPECT_EQ(report.state, CalibrationState::kDegenerate);
      EXPECT_FALSE(calibration.record.everIn(CalibrationState::kConverged));
      EXPECT_FALSE(calibration.record.everIn(CalibrationState::kConverging));
      EXPECT_FALSE(report.handed_over);
      EXPECT_FALSE(report.hint.empty());
    }
  }
}

}  // namespace
}  // namespace camera_self_calibration
