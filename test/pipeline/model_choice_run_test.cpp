// The whole system with the lens model left open, as it is by default.
#include <gtest/gtest.h>

#include <set>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {
namespace {

void expectFound(const Camera& truth) {
  SCOPED_TRACE(toString(truth.model()));
  TrackRun run(truth, Options(), TrackRunOptions());
  ASSERT_TRUE(run.runUntilConverged(600));
  const CalibrationReport report = run.report();
  EXPECT_EQ(report.camera.model(), truth.model()) << report.sentence;
  EXPECT_LT(pixelDistance(truth, report.camera).rms, 3.0 * report.uncertainty.rms);
  EXPECT_NE(report.sentence.find("lens model " + toString(truth.model())), std::string::npos)
      << report.sentence;
  // No going back and forth: what was left does not come back.
  std::set<CameraModel> left;
  for (std::size_t i = 1; i < run.record.reports.size(); ++i) {
    const CameraModel before = run.record.reports[i - 1].camera.model();
    const CameraModel now = run.record.reports[i].camera.model();
    if (now != before) left.insert(before);
    EXPECT_EQ(left.count(now), 0u) << toString(now) << " at report " << i;
  }
}

TEST(ModelChoiceRun, FindsAPinhole) {
  expectFound(camera640(CameraModel::kPinhole, {400, 404, 315, 243}));
}

TEST(ModelChoiceRun, FindsALensOf125Degrees) {
  expectFound(camera640(CameraModel::kFov, {311.2, 309.8, 327.4, 233.1, 0.93}));
}

TEST(ModelChoiceRun, FindsBarrelDistortion) {
  expectFound(camera640(CameraModel::kRadtan, {400, 404, 315, 243, -0.25, 0.05, 0.0005, -0.0005}));
}

TEST(ModelChoiceRun, FindsAFisheye) {
  expectFound(
      camera640(CameraModel::kEquidistant, {300, 302, 322, 238, 0.06, -0.03, 0.01, -0.004}));
}

TEST(ModelChoiceRun, WithoutInformationNothingIsChosen) {
  TrackRunOptions sideways;
  sideways.motion = MotionKind::kSidewaysOnly;
  const Camera truth = Camera::defaultGuess(CameraModel::kFov, 640, 480);
  TrackRun run(truth, Options(), sideways);
  run.run(200);
  EXPECT_FALSE(run.record.everIn(CalibrationState::kConverged));
}

}  // namespace
}  // namespace camera_self_calibration
