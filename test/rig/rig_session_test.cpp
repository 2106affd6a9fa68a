#include "camera_self_calibration/rig/rig_session.h"

#include <gtest/gtest.h>

#include "camera_self_calibration/geometry/so3.h"
#include "rig/played_rig.h"
#include "rig/simulated_rig.h"

namespace camera_self_calibration {
namespace {

Camera lens(double focal) {
  Intrinsics p(8);
  p << focal, focal, 322.0, 236.0, 0.02, 0.01, 0.0, 0.0;
  return Camera(CameraModel::kEquidistant, 640, 480, p);
}

const SimulatedRig& stereo() {
  static const SimulatedRig rig = [] {
    SimulatedRigOptions options;
    options.rig.cameras = {lens(400.0), lens(420.0)};
    options.rig.rig_from_camera = {Rigid3(),
                                   Rigid3(expSo3({0.02, -0.03, 0.05}), {0.12, 0.01, -0.005})};
    return simulateRig(options);
  }();
  return rig;
}

// A session that hears what the simulated cameras would say.
class Session {
 public:
  explicit Session(const RigOptions& options = {}) : session_(options, 2, stereo().across) {}

  RigSession& operator*() { return session_; }
  RigSession* operator->() { return &session_; }

  void lensesAreKnown() {
    for (int c = 0; c < 2; ++c) session_.update(c, knownLens(stereo().truth.cameras[c]));
  }

  // From what was saved, until the first joint solution.
  RigReport runFrom(const RigEstimate& before) {
    session_.restore(before);
    lensesAreKnown();
    see();
    return session_.solve();
  }

  // Every image is a keyframe. `later`: by how much the second camera's stamps are.
  void see(std::int64_t later_ns = 0) {
    for (const RigFrame& frame : stereo().frames) {
      for (int c = 0; c < 2; ++c) {
        FrameResult result = resultOf(frame, c);
        result.stamp_ns += c == 1 ? later_ns : 0;
        session_.add(c, result);
      }
    }
  }

 private:
  RigSession session_;
};

bool says(const RigReport& report, const std::string& words) {
  return report.sentence.find(words) != std::string::npos;
}

TEST(RigSession, WaitsForImagesThenForLenses) {
  Session session;
  EXPECT_TRUE(says(session->report(), "no image of camera 0")) << session->report().sentence;
  session.see();
  EXPECT_EQ(session->report().state, CalibrationState::kInitializing);
  EXPECT_TRUE(says(session->report(), "camera 0 does not know its lens"));
  EXPECT_EQ(session->report().keyframes, 0);
  EXPECT_FALSE(session->due());
}

TEST(RigSession, ConvergesOnWhatTheCamerasSee) {
  Session session;
  session.lensesAreKnown();
  session.see();
  EXPECT_EQ(session->report().keyframes, static_cast<int>(stereo().frames.size()));
  EXPECT_FALSE(session->report().estimate.usable);
  EXPECT_EQ(session->report().state, CalibrationState::kConverging);
  ASSERT_TRUE(session->due());
  const RigReport report = session->solve();
  EXPECT_FALSE(session->due());
  EXPECT_EQ(report.state, CalibrationState::kConverged) << report.sentence;
  EXPECT_EQ(report.revision, 1u);
  EXPECT_LT(angleBetween(report.estimate.rig.rig_from_camera[1].rotation,
                         stereo().truth.rig_from_camera[1].rotation),
            1e-3);
}

TEST(RigSession, WhatFailsReplacesNothing) {
  Session session;
  session.lensesAreKnown();
  session.see();
  const RigReport good = session->solve();
  // Seen again, as in a bag that is played again: what is there is replaced, and of so few frames
  // nothing can be said.
  FrameResult result;
  for (int c = 0; c < 2; ++c) {
    result.stamp_ns = stereo().frames.front().stamp_ns;
    result.is_keyframe = true;
    result.state = TrackingState::kTracking;
    session->add(c, result);
  }
  const RigReport report = session->solve();
  EXPECT_LT(report.keyframes, 5);
  EXPECT_FALSE(report.last_failure.empty());
  EXPECT_EQ(report.revision, good.revision);
  EXPECT_EQ(report.state, CalibrationState::kConverged);
  EXPECT_TRUE(report.estimate.usable);
}

// A keyframe of cameras that stand still, of which nothing can be said.
void seeStill(int frame, RigSession* session) {
  FrameResult result;
  result.stamp_ns = 200'000'000LL * frame;
  result.is_keyframe = true;
  result.state = TrackingState::kTracking;
  for (int c = 0; c < 2; ++c) session->add(c, result);
}

TEST(RigSession, WhatCannotBeSolvedIsNotSolvedAgainWithoutNewKeyframes) {
  Session session;
  session.lensesAreKnown();
  int frame = 0;
  while (frame < 120) seeStill(frame++, &*session);
  ASSERT_TRUE(session->mountsDue());
  EXPECT_FALSE(session->examineMounts().estimate.usable);
  EXPECT_FALSE(session->mountsDue());
  while (frame < 140) seeStill(frame++, &*session);
  EXPECT_TRUE(session->mountsDue());
}

TEST(RigSession, AChangedLensBeginsAnew) {
  Session session;
  session.lensesAreKnown();
  session.see();
  session->solve();
  session->update(1, knownLens(stereo().truth.cameras[1], 1));
  const RigReport report = session->report();
  EXPECT_EQ(report.state, CalibrationState::kConverging);
  EXPECT_TRUE(says(report, "lens of camera 1 has changed")) << report.sentence;
  EXPECT_EQ(report.keyframes, 0);
  EXPECT_EQ(report.epoch, 1u);
  EXPECT_TRUE(report.estimate.usable);
}

TEST(RigSession, ALensThatIsNotConvergedIsNamed) {
  Session session;
  session.lensesAreKnown();
  session.see();
  session->solve();
  CalibrationReport doubtful = knownLens(stereo().truth.cameras[1]);
  doubtful.state = CalibrationState::kConverging;
  doubtful.sentence = "two halves of the video disagree";
  session->update(1, doubtful);
  EXPECT_EQ(session->report().state, CalibrationState::kConverging);
  EXPECT_TRUE(says(session->report(), "Camera 1 is not CONVERGED: two halves"));
}

TEST(RigSession, SaysThatImagesAreNotTakenAtOnce) {
  Session session;
  session.lensesAreKnown();
  session.see(20'000'000);
  EXPECT_EQ(session->report().keyframes, 0);
  EXPECT_TRUE(says(session->report(), "differ by 20.0 ms")) << session->report().sentence;
  EXPECT_FALSE(session->solve().estimate.usable);
}

TEST(RigSession, JointIntrinsicsTakeThePlaceOfACamerasOwn) {
  Session session;
  session.lensesAreKnown();
  session.see();
  const RigReport report = session->solve();
  const CalibrationReport joint = withJointIntrinsics(report.cameras[1], report.estimate, 1, 1.0);
  EXPECT_EQ(joint.camera.parameters(), report.estimate.rig.cameras[1].parameters());
  EXPECT_EQ(joint.state, CalibrationState::kConverged);
  EXPECT_GT(joint.uncertainty.rms, 0.0);
  EXPECT_EQ(withJointIntrinsics(report.cameras[1], report.estimate, 1, 1e-6).state,
            CalibrationState::kConverging);
}

// What is left of an estimate when the program starts again.
RigEstimate saved(const RigReport& report) {
  RigEstimate estimate = report.estimate;
  estimate.evidence.reset();
  estimate.poses.erase(estimate.poses.begin(), estimate.poses.end() - 1);
  return estimate;
}

void turnSecond(RigEstimate* estimate) {
  Eigen::Quaterniond& rotation = estimate->rig.rig_from_camera[1].rotation;
  rotation = expSo3({0.004, -0.005, 0.003}) * rotation;
}

RigReport firstRun() {
  Session session;
  session.lensesAreKnown();
  session.see();
  return session->solve();
}

TEST(RigSession, ARestoredRigHoldsFromTheFirstImageAndIsChecked) {
  const RigReport before = firstRun();
  Session session;
  session->restore(saved(before));
  EXPECT_EQ(session->report().state, CalibrationState::kInitializing);
  session.lensesAreKnown();
  const RigReport restored = session->report();
  EXPECT_EQ(restored.state, CalibrationState::kConverged) << restored.sentence;
  EXPECT_TRUE(says(restored, "not compared with the images yet")) << restored.sentence;
  EXPECT_EQ(restored.estimate.rig.rig_from_camera[1].translation,
            before.estimate.rig.rig_from_camera[1].translation);
  session.see();
  const RigReport report = session->solve();
  EXPECT_EQ(report.state, CalibrationState::kConverged) << report.sentence;
  EXPECT_FALSE(says(report, "As it was saved")) << report.sentence;
  EXPECT_TRUE(report.mount_changes.empty());
  EXPECT_GT(report.revision, restored.revision);
}

TEST(RigSession, ACameraThatWasMovedMeanwhileIsFound) {
  RigEstimate before = saved(firstRun());
  turnSecond(&before);
  Session session;
  const RigReport report = session.runFrom(before);
  ASSERT_EQ(report.mount_changes.size(), 1u) << report.sentence;
  const MountChange& change = report.mount_changes.front();
  EXPECT_NE(change.sentence.find("not where it was when the rig was saved"), std::string::npos);
  EXPECT_LT((change.rotation - Eigen::Vector3d(-0.004, 0.005, -0.003)).norm(), 5e-4);
  EXPECT_EQ(change.epoch, report.epoch);
  EXPECT_EQ(report.state, CalibrationState::kConverged) << report.sentence;
  EXPECT_LT(angleBetween(report.estimate.rig.rig_from_camera[1].rotation,
                         stereo().truth.rig_from_camera[1].rotation),
            1e-3);
}

// By less than the sigmas of what was saved.
TEST(RigSession, ASavedRigThatWasVagueIsNoCameraThatWasMoved) {
  RigEstimate before = saved(firstRun());
  turnSecond(&before);
  before.places[1].difference_covariance += 1e-5 * PlaceMatrix::Identity();
  Session session;
  EXPECT_TRUE(session.runFrom(before).mount_changes.empty());
}

// Sits where it did, and the saved rig says how long a metre is.
TEST(RigSession, WhatWasMetricStaysMetricWithoutABaseline) {
  RigEstimate before = saved(firstRun());
  ASSERT_FALSE(before.metric);
  setBaseline(0.12, &before);
  Session session;
  const RigEstimate estimate = session.runFrom(before).estimate;
  EXPECT_TRUE(estimate.evidence) << estimate.sentence;  // solved, not restored
  EXPECT_TRUE(estimate.metric) << estimate.sentence;
  EXPECT_NEAR(estimate.rig.rig_from_camera[1].translation.norm(), 0.12, 1e-9);
}

TEST(RigSession, AnotherUnitLeavesTheVerdictOnTheClocks) {
  RigEstimate estimate = firstRun().estimate;
  ASSERT_TRUE(estimate.converged) << estimate.sentence;
  estimate.places[1].time_offset.seconds = 0.007;
  estimate.places[1].time_offset.sigma = 1e-4;
  setBaseline(0.12, &estimate);
  EXPECT_FALSE(estimate.converged);
  EXPECT_NE(estimate.sentence.find("7.0 ms"), std::string::npos) << estimate.sentence;
  EXPECT_NE(estimate.hint.find("stamps"), std::string::npos) << estimate.hint;
}

// Along the baseline a shift does not show: whatever was moved, the length may be another one.
TEST(RigSession, ASavedBaselineIsForgottenWhereACameraWasMoved) {
  RigEstimate before = saved(firstRun());
  setBaseline(0.12, &before);
  turnSecond(&before);
  for (const double alarms : {0.1, 0.0}) {
    RigOptions options;
    options.false_alarms_per_hour = alarms;
    Session session(options);
    const RigReport report = session.runFrom(before);
    EXPECT_FALSE(report.estimate.metric) << report.estimate.sentence;
    EXPECT_NEAR(report.estimate.rig.rig_from_camera[1].translation.norm(), 1.0, 1e-9);
    ASSERT_EQ(report.mount_changes.size(), alarms > 0.0 ? 1u : 0u) << report.sentence;
    if (alarms == 0.0) continue;
    EXPECT_NE(report.mount_changes[0].sentence.find("in metres no longer"), std::string::npos)
        << report.mount_changes[0].sentence;
  }
}

TEST(RigSession, AGivenBaselineIsNotDoubted) {
  RigEstimate before = saved(firstRun());
  setBaseline(0.5, &before);
  turnSecond(&before);
  RigOptions options;
  options.baseline_m = 0.12;
  Session session(options);
  session->restore(before);
  EXPECT_NEAR(session->report().estimate.rig.rig_from_camera[1].translation.norm(), 0.12, 1e-9);
  session.lensesAreKnown();
  session.see();
  const RigReport report = session->solve();
  ASSERT_EQ(report.mount_changes.size(), 1u) << report.sentence;
  EXPECT_EQ(report.mount_changes[0].sentence.find("no longer"), std::string::npos)
      << report.mount_changes[0].sentence;
  EXPECT_TRUE(report.estimate.metric);
  EXPECT_NEAR(report.estimate.rig.rig_from_camera[1].translation.norm(), 0.12, 1e-9);
}

// Whoever changed the lens may have moved the camera.
TEST(RigSession, ALensThatChangedBeforeTheFirstComparisonEndsTheSavedBaseline) {
  RigEstimate before = saved(firstRun());
  setBaseline(0.12, &before);
  Session session;
  session->restore(before);
  session.lensesAreKnown();
  session->update(1, knownLens(stereo().truth.cameras[1], 1));
  session.see();
  const RigReport report = session->solve();
  ASSERT_TRUE(report.estimate.evidence) << report.sentence;
  EXPECT_FALSE(report.estimate.metric) << report.estimate.sentence;
}

TEST(RigSession, ALensThatChangedEndsWhatWasRestored) {
  Session session;
  session->restore(saved(firstRun()));
  session.lensesAreKnown();
  ASSERT_EQ(session->report().state, CalibrationState::kConverged);
  session->update(1, knownLens(stereo().truth.cameras[1], 1));
  EXPECT_EQ(session->report().state, CalibrationState::kConverging);
  EXPECT_FALSE(says(session->report(), "As it was saved")) << session->report().sentence;
}

}  // namespace
}  // namespace camera_self_calibration
