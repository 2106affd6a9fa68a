#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "benchmark/degenerate_trial.h"
#include "benchmark/random_lens.h"
#include "pipeline/track_run.h"
#include "sanitized.h"

namespace camera_self_calibration {
namespace {

DegenerateTrial trialOf(Degeneracy degeneracy, CameraModel model, std::uint64_t seed) {
  DegenerateTrial trial;
  trial.degeneracy = degeneracy;
  trial.truth = randomLens(model, 640, 480, seed).camera;
  trial.seed = seed;
  trial.degenerate_s = kSanitized ? 10.0 : 20.0;
  trial.rate_hz = 10.0;
  return trial;
}

DegenerateOutcome runAndTell(const DegenerateTrial& trial) {
  const DegenerateOutcome outcome = run(trial, 10.0);
  std::cout << toString(trial.degeneracy) << ", " << toString(trial.truth.model()) << ": states "
            << outcome.states << ", " << outcome.sentence << "; converged " << outcome.recovered_s
            << " s after good motion began, error " << outcome.error_px << " px, stated "
            << outcome.stated_px << " px\n";
  return outcome;
}

// What motion does not tell is not believed, is named, and good motion tells it then.
TEST(Degenerate, NothingIsPublishedThatIsNotKnown) {
  const std::pair<Degeneracy, CameraModel> cases[] = {
      {Degeneracy::kForward, CameraModel::kFov},
      {Degeneracy::kPan, CameraModel::kPinhole},
      {Degeneracy::kFrontalPlane, CameraModel::kEquidistant}};
  for (const auto& [degeneracy, model] : cases) {
    if (kSanitized && degeneracy != Degeneracy::kForward) continue;
    const DegenerateOutcome outcome = runAndTell(trialOf(degeneracy, model, 3));
    EXPECT_EQ(outcome.converged_s, -1.0);
    EXPECT_EQ(outcome.states.find('C'), std::string::npos);
    EXPECT_GT(outcome.unfinished, 0);
    EXPECT_EQ(outcome.hinted, outcome.unfinished);
    EXPECT_EQ(outcome.named, outcome.unfinished);
    EXPECT_EQ(outcome.final_state, "CONVERGED");
    EXPECT_GT(outcome.published, 0);
    EXPECT_LT(outcome.worst_ratio, 3.0);
    EXPECT_LT(outcome.worst_sigmas, 4.0);
  }
}

// Singular, yet informative: no class of motion is refused.
TEST(Degenerate, TurningOnTheSpotConverges) {
  const DegenerateOutcome outcome =
      runAndTell(trialOf(Degeneracy::kTurning, CameraModel::kPinhole, 19));
  EXPECT_GE(outcome.converged_s, 0.0);
  EXPECT_LT(outcome.worst_ratio, 3.0);
  EXPECT_LT(outcome.worst_sigmas, 4.0);
}

// Any displacement of the pixels that follows their curves changes nothing here: the noise must not
// look like one, as if no model described the lens.
TEST(Degenerate, TurningAboutOneAxisSpeaksAgainstNoLens) {
  for (const Degeneracy degeneracy : {Degeneracy::kPan, Degeneracy::kTilt}) {
    DegenerateTrial trial = trialOf(degeneracy, CameraModel::kRadtan, 11);
    trial.degenerate_s = 25.0;
    trial.rate_hz = 15.0;
    const DegenerateOutcome outcome = runAndTell(trial);
    EXPECT_EQ(outcome.state, "CONVERGED");
    EXPECT_LT(outcome.worst_ratio, 3.0);
  }
}

// Depths that come of noise lead into a wrong minimum when the camera moves on: of the trajectory,
// and then it looks like a change of the lens.
TEST(Degenerate, MotionAfterTurningAboutOneAxisIsNoChangeOfTheLens) {
  DegenerateTrial trial = trialOf(Degeneracy::kPan, CameraModel::kRadtan, 11);
  trial.degenerate_s = 25.0;
  const DegenerateOutcome outcome = runAndTell(trial);
  EXPECT_EQ(outcome.changes, 0);
  EXPECT_EQ(outcome.final_state, "CONVERGED");
  EXPECT_LT(outcome.worst_ratio, 3.0);
  EXPECT_LT(outcome.travel_deg, 5.0);
}

TEST(Degenerate, AConvergedCalibrationIsLeftAsItIs) {
  for (const Degeneracy degeneracy : {Degeneracy::kForward, Degeneracy::kStanding}) {
    DegenerateTrial trial = trialOf(degeneracy, CameraModel::kRadtan, 4);
    trial.good_first = true;
    trial.good_s = 15.0;
    const DegenerateOutcome outcome = run(trial, 10.0);
    EXPECT_EQ(outcome.final_state, "CONVERGED");
    EXPECT_EQ(outcome.left_converged, 0);
    EXPECT_EQ(outcome.changes, 0);
    EXPECT_LT(outcome.wander_px, 0.01);
    EXPECT_LT(outcome.worst_ratio, 3.0);
  }
}

// What nothing tells keeps its last trusted value in all that is reported.
TEST(Degenerate, WhatIsNotKnownStaysAsItWas) {
  const Camera truth = randomLens(CameraModel::kPinhole, 640, 480, 5).camera;
  TrackRunOptions run;
  run.motion = MotionKind::kForwardOnly;
  run.motion_speed = 1.5;
  run.rate_hz = 8.0;
  TrackRun calibration(truth, optionsFor(truth.model()), run);
  calibration.run(kSanitized ? 60 : 120);
  const Camera guess = Camera::defaultGuess(CameraModel::kPinhole, 640, 480);
  int degenerate = 0;
  for (const CalibrationReport& report : calibration.record.reports) {
    if (report.state != CalibrationState::kDegenerate) continue;
    ++degenerate;
    EXPECT_NEAR(report.camera.parameters()(0), guess.parameters()(0), 20.0);
  }
  EXPECT_GT(degenerate, 0);
}

// Rotation on the spot tells no lengths; the map's scale must not run away.
TEST(Degenerate, TheScaleDoesNotRunAway) {
  const Camera truth = randomLens(CameraModel::kFov, 640, 480, 2).camera;
  TrackRunOptions run;
  run.motion = MotionKind::kRotationOnly;
  run.motion_speed = 1.0;
  TrackRun calibration(truth, optionsFor(truth.model()), run);
  calibration.run(kSanitized ? 150 : 400);
  double farthest = 0.0;
  for (const FrameResult& frame : calibration.record.frames) {
    farthest = std::max(farthest, frame.world_from_camera.translation.norm());
  }
  std::cout << "farthest " << farthest << " map units after " << calibration.report().keyframes
            << " keyframes\n";
  EXPECT_LT(farthest, 1e7);
  EXPECT_EQ(calibration.record.count(EventType::kLost), 0);
}

}  // namespace
}  // namespace camera_self_calibration
