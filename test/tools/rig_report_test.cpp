#include "camera_self_calibration/tools/rig_report.h"

#include <gtest/gtest.h>

#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/tools/rig_results.h"

namespace camera_self_calibration {
namespace {

Camera lens() {
  Intrinsics p(8);
  p << 400.0, 401.0, 322.0, 236.0, 0.02, 0.01, 0.0, 0.0;
  return Camera(CameraModel::kEquidistant, 640, 480, p);
}

// A pair that sees a grid of points exactly; before it was solved, a little off.
RigRecording pair() {
  RigRecording recording;
  recording.topics = {"/left & /co", "/right"};
  recording.cameras.resize(2);
  for (Recording& camera : recording.cameras) {
    camera.final_report.camera = lens();
    camera.final_report.state = CalibrationState::kConverged;
  }
  RigEstimate& estimate = recording.estimate;
  estimate.usable = estimate.converged = true;
  estimate.sentence = "camera 1 sits where it should";
  estimate.rig = {{lens(), lens()}, {Rigid3(), Rigid3(expSo3({0.0, 0.01, 0.0}), {1.0, 0.0, 0.0})}};
  estimate.places.resize(2);
  estimate.places[1].position_known = true;
  estimate.poses.resize(1);
  auto evidence = std::make_shared<RigEvidence>();
  evidence->before = estimate.rig;
  Rigid3& before = evidence->before.rig_from_camera[1];
  before.rotation = expSo3({0.005, 0.0, 0.0}) * before.rotation;
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3d point(0.4 * (i % 20) - 3.8, 0.3 * (i / 20) - 2.8, 8.0);
    SharedView view;
    view.to = 1;
    const Rigid3 right_from_left = estimate.rig.rig_from_camera[1].inverse();
    if (!lens().project(point, &view.from_pixel)) continue;
    if (lens().project(right_from_left * point, &view.to_pixel)) evidence->shared.push_back(view);
  }
  estimate.evidence = evidence;
  return recording;
}

std::string page(const RigRecording& recording) {
  RunDescription run;
  run.input = "/videos/pair.bag";
  return rigReportHtml(run, recording, std::nullopt, {});
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(RigReport, ShowsPosesEpipolarErrorsAndWhatToCopy) {
  const std::string text = page(pair());
  EXPECT_TRUE(has(text, "<title>Rig calibration: pair.bag</title>"));
  EXPECT_TRUE(has(text, "CONVERGED"));
  EXPECT_TRUE(has(text, "Camera 1 sits where it should."));
  EXPECT_TRUE(has(text, "/left &amp; /co"));
  EXPECT_TRUE(has(text, "href=\"cam1/report.html\""));
  EXPECT_TRUE(has(text, "Epipolar error over the image"));
  EXPECT_TRUE(has(text, "400 shared views agree to 0.000 px"));
  EXPECT_TRUE(has(text, "T_cn_cnm1"));
  EXPECT_FALSE(has(text, "Is the calibration in question"));
  EXPECT_FALSE(has(text, "Cameras that were moved"));
}

TEST(RigReport, AnAuditHasItsSection) {
  RigRecording recording = pair();
  recording.audited = recording.estimate.rig;
  recording.audit.emplace();
  recording.audit->lenses.resize(2);
  recording.audit->places.resize(1);
  recording.audit->places[0].verdict = AuditVerdict::kWrong;
  recording.audit->places[0].sentence = "camera 1 is not where the calibration puts it";
  const std::string text = page(recording);
  EXPECT_TRUE(has(text, "Is the calibration in question still right?"));
  EXPECT_TRUE(has(text, "Camera 1 is not where the calibration puts it."));
  EXPECT_TRUE(has(text, "the calibration in question [px rms]"));
  EXPECT_TRUE(has(rigText(recording), "audit of the rig: WRONG"));
}

TEST(RigReport, ARigOfWhichNothingIsKnownSaysWhy) {
  RigRecording recording = pair();
  recording.estimate = RigEstimate();
  recording.estimate.sentence = "the motion does not tell how camera 1 is turned";
  const std::string text = page(recording);
  EXPECT_TRUE(has(text, "The motion does not tell how camera 1 is turned."));
  EXPECT_TRUE(has(text, "There is none: an estimate that has not CONVERGED"));
  for (const char* title : {"Where the cameras sit", "Epipolar error", "The rectified pair"}) {
    EXPECT_FALSE(has(text, std::string(">") + title + "<")) << title;
  }
}

}  // namespace
}  // namespace camera_self_calibration
