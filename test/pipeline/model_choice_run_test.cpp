// The whole system with the lens model left open.
#include <gtest/gtest.h>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {
namespace {

Options openOptions() {
  Options options;
  options.choose_model = true;
  return options;
}

TEST(ModelChoiceRun, FindsTheModelAndConverges) {
  Intrinsics parameters(8);
  parameters << 400, 404, 315, 243, -0.25, 0.05, 0.0005, -0.0005;
  const Camera truth(CameraModel::kRadtan, 640, 480, parameters);
  TrackRun run(truth, openOptions(), TrackRunOptions());
  ASSERT_TRUE(run.runUntilConverged(600));
  const CalibrationReport report = run.report();
  EXPECT_EQ(report.camera.model(), CameraModel::kRadtan);
  EXPECT_LT(pixelDistance(truth, report.camera).rms, 3.0 * report.uncertainty.rms);
  EXPECT_NE(report.sentence.find("lens model radtan"), std::string::npos) << report.sentence;
  // Once it has been chosen there is no going back and forth.
  int switches = 0;
  for (std::size_t i = 1; i < run.record.reports.size(); ++i) {
    switches += run.record.reports[i].camera.model() != run.record.reports[i - 1].camera.model();
  }
  EXPECT_EQ(switches, 1);
}

TEST(ModelChoiceRun, WithoutInformationNothingIsChosen) {
  TrackRunOptions still;
  still.motion = MotionKind::kSidewaysOnly;
  const Camera truth = Camera::defaultGuess(CameraModel::kFov, 640, 480);
  TrackRun run(truth, openOptions(), still);
  run.run(200);
  EXPECT_FALSE(run.record.everIn(CalibrationState::kConverged));
}

}  // namespace
}  // namespace camera_self_calibration
