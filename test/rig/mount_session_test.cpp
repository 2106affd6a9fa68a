// A camera that is turned while a session runs, on simulated features.

#include <gtest/gtest.h>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/geometry/so3.h"
#include "rig/played_rig.h"

namespace camera_self_calibration {
namespace {

constexpr double kChangeS = 8.7;  // in the middle of a segment

Camera lens(double focal) {
  Intrinsics p(8);
  p << focal, focal, 322.0, 236.0, 0.02, 0.01, 0.0, 0.0;
  return Camera(CameraModel::kEquidistant, 640, 480, p);
}

SimulatedRigOptions stereo() {
  SimulatedRigOptions options;
  options.rig.cameras = {lens(400.0), lens(420.0)};
  options.rig.rig_from_camera = {Rigid3(),
                                 Rigid3(expSo3({0.02, -0.03, 0.05}), {0.12, 0.01, -0.005})};
  options.frames = 80;
  options.change_at_s = kChangeS;
  return options;
}

SimulatedRigOptions bumped(double by = 1.0) {
  SimulatedRigOptions options = stereo();
  options.bump.rotation = expSo3(by * kDegree * Eigen::Vector3d(0.3, -0.2, 0.35));
  return options;
}

RigReport solvedAtTheEnd(const SimulatedRigOptions& options) {
  const SimulatedRig rig = simulateRig(options);
  RigSession session({}, rig.truth.size(), rig.across);
  return playThenSolve(rig, rig.truth.cameras, &session);
}

std::size_t alarms(const SimulatedRigOptions& options) {
  const SimulatedRig rig = simulateRig(options);
  RigSession session({}, rig.truth.size(), rig.across);
  play(rig, rig.truth.cameras, &session);
  return session.report().mount_changes.size();
}

TEST(MountSession, ATurnedCameraIsFoundAndTheRigLearntAnew) {
  const SimulatedRigOptions options = bumped();
  const SimulatedRig rig = simulateRig(options);
  RigOptions named;
  named.names = {"left", "right"};
  RigSession session(named, 2, rig.across);
  bool known = false, anew = false;
  std::string sentence;
  play(rig, rig.truth.cameras, &session, [&](const RigReport& report) {
    known = known || (report.mount_changes.empty() && report.state == CalibrationState::kConverged);
    if (report.mount_changes.empty() || anew) return;
    anew = true;
    sentence = report.sentence;
    EXPECT_EQ(report.state, CalibrationState::kConverging);
    EXPECT_LT(report.keyframes, 45);
    EXPECT_EQ(report.epoch, 1u);
    EXPECT_TRUE(report.estimate.usable);
  });
  EXPECT_TRUE(known);
  ASSERT_TRUE(anew);
  EXPECT_EQ(sentence.find("Camera right was turned by 0.5"), 0u) << sentence;
  EXPECT_NE(sentence.find("degrees against camera left at "), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("; calibrating the rig again."), std::string::npos) << sentence;
  const RigReport last = session.report();
  ASSERT_EQ(last.mount_changes.size(), 1u);
  const MountChange& change = last.mount_changes.front();
  EXPECT_NEAR(toSeconds(change.onset_ns), kChangeS, 1.0);
  const Eigen::Vector3d turn =
      options.rig.rig_from_camera[1].rotation * logSo3(options.bump.rotation);
  EXPECT_LT((change.rotation - turn).norm(), 4.0 * change.angleSigma() + 0.01 * kDegree);
  EXPECT_EQ(last.state, CalibrationState::kConverged) << last.sentence;
  EXPECT_LT(angleBetween(last.estimate.rig.rig_from_camera[1].rotation,
                         afterBump(options).rig_from_camera[1].rotation),
            0.1 * kDegree);
}

TEST(MountSession, NoAlarmWhereNothingChanges) { EXPECT_EQ(alarms(stereo()), 0u); }

// Although its camera does not say so.
TEST(MountSession, AZoomIsNoMount) {
  SimulatedRigOptions options = stereo();
  options.zoom = 1.01;
  options.change_at_s = 6.1;
  options.frames = 60;
  const SimulatedRig rig = simulateRig(options);
  RigSession session({}, 2, rig.across);
  play(rig, rig.truth.cameras, &session);
  const RigReport last = session.report();
  EXPECT_TRUE(last.mount_changes.empty()) << last.mount_changes.front().sentence;
  EXPECT_EQ(last.state, CalibrationState::kConverging);
  EXPECT_NE(last.sentence.find("the lens of camera 1 may have changed"), std::string::npos)
      << last.sentence;
}

// As offline: keyframes from before and after are solved together first.
TEST(MountSession, WhatIsMixedIsNotBelieved) {
  const SimulatedRigOptions options = bumped();
  const RigReport report = solvedAtTheEnd(options);
  ASSERT_EQ(report.mount_changes.size(), 1u) << report.sentence;
  EXPECT_LT(report.keyframes, 45);
  EXPECT_EQ(report.solutions, 2);
  EXPECT_LT(angleBetween(report.estimate.rig.rig_from_camera[1].rotation,
                         afterBump(options).rig_from_camera[1].rotation),
            0.1 * kDegree);
}

// Too few keyframes to tell a change from a segment that is wrong, and enough not to be sure.
TEST(MountSession, SoonAfterAChangeTheRigIsInDoubt) {
  SimulatedRigOptions options = bumped();
  options.change_at_s = 10.1;
  options.frames = 59;
  const RigReport report = solvedAtTheEnd(options);
  EXPECT_TRUE(report.mount_changes.empty());
  EXPECT_EQ(report.state, CalibrationState::kConverging) << report.sentence;
  EXPECT_NE(report.sentence.find("amera 1 may have been moved"), std::string::npos)
      << report.sentence;
}

// Some of its keyframes.
SimulatedRig part(const SimulatedRig& rig, int begin, int end) {
  return {rig.truth, {rig.frames.begin() + begin, rig.frames.begin() + end}, rig.across};
}

// The estimate is that from before, and not to be used as it is.
TEST(MountSession, WhatMovedAtTheVeryEndLeavesNoConvergedEstimate) {
  SimulatedRigOptions options = bumped(2.0);
  options.change_at_s = 13.9;  // after 70 keyframes
  const SimulatedRig rig = simulateRig(options);
  RigSession session({}, 2, rig.across);
  const RigReport before = playThenSolve(part(rig, 0, 70), rig.truth.cameras, &session);
  ASSERT_EQ(before.state, CalibrationState::kConverged) << before.sentence;
  EXPECT_TRUE(withVerdict(before).converged);
  EXPECT_EQ(withVerdict(before).sentence, before.estimate.sentence);
  const RigReport report = playThenSolve(part(rig, 70, 79), rig.truth.cameras, &session);
  EXPECT_TRUE(report.mount_changes.empty());
  EXPECT_EQ(report.revision, before.revision);
  EXPECT_EQ(report.state, CalibrationState::kConverging) << report.sentence;
  const RigEstimate estimate = withVerdict(report);
  EXPECT_TRUE(estimate.usable);
  EXPECT_FALSE(estimate.converged);
  EXPECT_NE(estimate.sentence.find("Camera 1 may have been moved"), std::string::npos)
      << estimate.sentence;
}

// A change after a single segment is not told from a segment that is wrong.
TEST(MountSession, ASegmentThatIsWrongIsNoPartOfTheFirstSolution) {
  SimulatedRigOptions options = bumped(2.0);
  options.change_at_s = 1.9;
  options.frames = 60;
  const RigReport report = solvedAtTheEnd(options);
  EXPECT_TRUE(report.mount_changes.empty());
  EXPECT_EQ(report.keyframes, 50);
  EXPECT_EQ(report.solutions, 2);
  ASSERT_TRUE(report.estimate.usable) << report.sentence;
  EXPECT_GT(toSeconds(report.estimate.poses.front().stamp_ns), options.change_at_s);
}

// Although there is no estimate yet when it is found.
TEST(MountSession, AShiftIsInMetresWhereTheBaselineIsGiven) {
  SimulatedRigOptions options = bumped();
  options.bump.translation = {0.0, 0.01, 0.0};
  const SimulatedRig rig = simulateRig(options);
  RigOptions metric;
  metric.baseline_m = options.rig.rig_from_camera[1].translation.norm();
  RigSession session(metric, 2, rig.across);
  const RigReport report = playThenSolve(rig, rig.truth.cameras, &session);
  ASSERT_EQ(report.mount_changes.size(), 1u) << report.sentence;
  const MountChange& change = report.mount_changes.front();
  EXPECT_NEAR(change.shift.norm(), 0.01, 0.004);
  EXPECT_NE(change.sentence.find(" m against camera 0"), std::string::npos) << change.sentence;
}

TEST(MountSession, OfThreeCamerasTheOneThatMovedIsNamed) {
  SimulatedRigOptions options = bumped();
  options.rig.cameras.push_back(lens(380.0));
  options.rig.rig_from_camera.emplace_back(expSo3({0.0, 0.4, 0.0}),
                                           Eigen::Vector3d(0.1, 0.0, -0.2));
  options.changed = 0;
  options.frames = 60;
  options.change_at_s = 6.1;
  const RigReport report = solvedAtTheEnd(options);
  ASSERT_EQ(report.mount_changes.size(), 1u) << report.sentence;
  const MountChange& change = report.mount_changes.front();
  EXPECT_EQ(change.camera, 0) << change.sentence;
  EXPECT_NEAR(change.angle(), logSo3(options.bump.rotation).norm(), 0.05 * kDegree);
  EXPECT_NE(change.sentence.find("against the others"), std::string::npos);
}

TEST(MountSession, NeverAnAlarmAtARateOfZero) {
  const SimulatedRigOptions options = bumped();
  const SimulatedRig rig = simulateRig(options);
  RigOptions never;
  never.false_alarms_per_hour = 0.0;
  RigSession session(never, 2, rig.across);
  const RigReport report = playThenSolve(rig, rig.truth.cameras, &session);
  EXPECT_TRUE(report.mount_changes.empty());
  EXPECT_EQ(report.state, CalibrationState::kConverging);
}

}  // namespace
}  // namespace camera_self_calibration
