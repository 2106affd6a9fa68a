// The whole system but the images: what it says of right and wrong calibrations.

#include <gtest/gtest.h>

#include "audit/audit_samples.h"
#include "camera_self_calibration/audit/audit_history.h"
#include "camera_self_calibration/base/stamp.h"
#include "pipeline/track_run.h"
#include "sanitized.h"

namespace camera_self_calibration {
namespace {

const Camera kLens = camera640(CameraModel::kRadtan, {400, 402, 325, 236, -0.28, 0.07, 2e-4, 0});

TrackRunOptions runOptions() {
  TrackRunOptions run;
  run.rate_hz = 10.0;
  run.max_features = 60;
  return run;
}

TEST(AuditRun, JudgesByWhatTracksSay) {
  TrackRun run(kLens, optionsFor(CameraModel::kRadtan), runOptions());
  EXPECT_EQ(audit(kLens, run.report(), AuditOptions()).verdict, AuditVerdict::kCannotTell);
  ASSERT_TRUE(run.runUntilConverged(200));
  run.run(kSanitized ? 40 : 100);
  const AuditReport good = audit(kLens, run.report(), AuditOptions());
  EXPECT_EQ(good.verdict, AuditVerdict::kGood) << good.sentence();
  const AuditReport longer = audit(changed(kLens, 1.01, {0, 0}), run.report(), AuditOptions());
  EXPECT_EQ(longer.verdict, AuditVerdict::kWrong) << longer.sentence();
  EXPECT_EQ(longer.cause, LikelyCause::kFocalLength) << longer.sentence();
  const AuditReport other = audit(changed(kLens, 1.0, {16, 9}), run.report(), AuditOptions());
  EXPECT_EQ(other.verdict, AuditVerdict::kWrong) << other.sentence();
  EXPECT_EQ(other.cause, LikelyCause::kPrincipalPoint) << other.sentence();
}

TEST(AuditRun, DatesAZoom) {
  constexpr double kZoomS = 20.0;
  TrackRunOptions options = runOptions();
  const Camera zoomed = changed(kLens, 1.05, {0, 0});
  options.lens = [&](double t) { return t < kZoomS ? kLens : zoomed; };
  TrackRun run(kLens, optionsFor(CameraModel::kRadtan), options);
  AuditHistory history;
  AuditReport newest;
  for (int i = 0; i < 300; ++i) {
    run.step();
    newest = audit(kLens, run.report(), AuditOptions());
    history.date(run.report(), &newest);
  }
  ASSERT_EQ(newest.verdict, AuditVerdict::kWrong) << newest.sentence();
  ASSERT_TRUE(newest.since_ns);
  EXPECT_NEAR(toSeconds(*newest.since_ns) - 1.0, kZoomS, 0.3);
  EXPECT_EQ(newest.cause, LikelyCause::kFocalLength) << newest.sentence();
}

}  // namespace
}  // namespace camera_self_calibration
