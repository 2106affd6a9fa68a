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
  Session() : session_({}, 2, stereo().across) {}

  RigSession& operator*() { return session_; }
  RigSession* operator->() { return &session_; }

  void lensesAreKnown() {
    for (int c = 0; c < 2; ++c) session_.update(c, knownLens(stereo().truth.cameras[c]));
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

}  // namespace
}  // namespace camera_self_calibration
