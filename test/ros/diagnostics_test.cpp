// What an operator reads on /diagnostics: levels and whole texts.

#include <gtest/gtest.h>

#include "camera_self_calibration/rig_node/rig_judgement.h"
#include "camera_self_calibration/ros/diagnostic_entries.h"
#include "camera_self_calibration/ros/judgement.h"
#include "camera_self_calibration/ros/storage_status.h"

namespace camera_self_calibration {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using Status = diagnostic_updater::DiagnosticStatusWrapper;

void expectSays(const Status& status, int level, const std::string& text) {
  EXPECT_EQ(static_cast<int>(status.level), level) << status.message;
  EXPECT_EQ(status.message, text);
}

/// Of an entry's key; empty if it has no such key.
std::string valueOf(const Status& status, const std::string& key) {
  for (const auto& pair : status.values) {
    if (pair.key == key) return pair.value;
  }
  return {};
}

CalibrationReport converged() {
  CalibrationReport report;
  report.state = CalibrationState::kConverged;
  report.sentence = "the calibration is good to 0.31 px rms over the image";
  return report;
}

CameraInfoState published() {
  CameraInfoState info;
  info.distortion_model = "equidistant";
  return info;
}

Status calibration(const CalibrationReport& report, const CameraInfoState& info,
                   const std::optional<Event>& event = std::nullopt) {
  Status status;
  describeCalibration(report, info, event, &status);
  return status;
}

Status queue(std::size_t segments, const std::string& decision) {
  QueueReport report;
  report.segments.resize(segments);
  report.last_decision = decision;
  Status status;
  describeQueue(report, &status);
  return status;
}

TEST(Judgement, TheHighestLevelCountsAndAllSentencesAreKept) {
  Status status;
  status.summary(DiagnosticStatus::OK, "All is well.");
  addJudgement(DiagnosticStatus::OK, "so is the rest", &status);
  expectSays(status, DiagnosticStatus::OK, "All is well. So is the rest.");
  addJudgement(DiagnosticStatus::ERROR, "The disk is full.", &status);
  addJudgement(DiagnosticStatus::WARN, "", &status);
  addJudgement(DiagnosticStatus::WARN, "The lens is dirty.", &status);
  expectSays(status, DiagnosticStatus::ERROR,
             "All is well. So is the rest. The disk is full. The lens is dirty.");
}

TEST(CalibrationEntry, Converged) {
  const Status status = calibration(converged(), published());
  expectSays(status, DiagnosticStatus::OK,
             "The calibration is good to 0.31 px rms over the image.");
  EXPECT_EQ(valueOf(status, "state"), "CONVERGED");
  EXPECT_EQ(valueOf(status, "camera_info"), "equidistant");
}

TEST(CalibrationEntry, NotConvergedWithWhatWouldHelp) {
  expectSays(calibration(CalibrationReport(), CameraInfoState()), DiagnosticStatus::WARN,
             "Nothing is known yet.");
  CalibrationReport report = converged();
  report.state = CalibrationState::kConverging;
  report.sentence = "the calibration is good to 2.10 px rms (needed: 1.00 px)";
  report.hint = "turn the camera about its optical axis";
  const Status status = calibration(report, CameraInfoState());
  expectSays(status, DiagnosticStatus::WARN,
             "The calibration is good to 2.10 px rms (needed: 1.00 px). Turn the camera about its "
             "optical axis.");
  EXPECT_EQ(valueOf(status, "camera_info"), "zeros: not calibrated");
}

TEST(CalibrationEntry, WhereTheCameraInfoComesFromIsSaidAtOnce) {
  CameraInfoState info = published();
  info.inherited = true;
  expectSays(calibration(converged(), info), DiagnosticStatus::OK,
             "The calibration is good to 0.31 px rms over the image. camera_info is what was known "
             "before the images changed, until they confirm or replace it.");
  info.inherited = false;
  info.given = true;
  expectSays(calibration(converged(), info), DiagnosticStatus::OK,
             "The calibration is good to 0.31 px rms over the image. camera_info is the one from "
             "set_camera_info, until the images confirm or replace it.");
}

TEST(CalibrationEntry, TwoWarningsTogether) {
  CalibrationReport report = converged();
  report.state = CalibrationState::kConverging;
  report.sentence = "the newest segments disagree";
  CameraInfoState info = published();
  info.last_good = true;
  info.deviation = "The published camera_info (equidistant) deviates by up to 0.30 px.";
  expectSays(calibration(report, info), DiagnosticStatus::WARN,
             "The newest segments disagree. The calibration is no longer CONVERGED; camera_info "
             "still carries the last one that was. The published camera_info (equidistant) "
             "deviates by up to 0.30 px.");
}

TEST(CalibrationEntry, AVerdictStaysBesideWhyZerosGoOut) {
  CameraInfoState info;
  info.obstacle = "The fov lens cannot be expressed.";
  expectSays(calibration(converged(), info), DiagnosticStatus::ERROR,
             "The calibration is good to 0.31 px rms over the image. The fov lens cannot be "
             "expressed.");
}

TEST(CalibrationEntry, WordsOfTheEstimatorAreExplained) {
  const auto event = [](EventType type) {
    return valueOf(
        calibration(converged(), published(), Event{type, 12500000000, 12500000000, "it is so"}),
        "last event");
  };
  EXPECT_EQ(event(EventType::kHandover),
            "HANDOVER at 12.500 s: It is so. (HANDOVER: the queue of the most informative segments "
            "gives the calibration from now on.)");
  EXPECT_EQ(event(EventType::kConverged),
            "CONVERGED at 12.500 s: It is so. (CONVERGED: the calibration is good enough for use, "
            "and camera_info is published.)");
  EXPECT_EQ(
      event(EventType::kNoLongerConverged),
      "NO_LONGER_CONVERGED at 12.500 s: It is so. (NO_LONGER_CONVERGED: the calibration is not "
      "good enough for use any more.)");
  EXPECT_EQ(
      event(EventType::kCalibrationChange),
      "CALIBRATION_CHANGE at 12.500 s: It is so. (CALIBRATION_CHANGE: the images no longer fit "
      "the calibration that was in use, as after a bump, a zoom or a new focus.)");
  CalibrationReport missed = converged();
  missed.lens_fit.compared = missed.lens_fit.refuted = true;
  missed.lens_fit.model = "radtan";
  missed.lens_fit.better = "fov";
  missed.lens_fit.misfit = {1.2, 4.0};
  EXPECT_EQ(valueOf(calibration(missed, published()), "lens fit"),
            "radtan misses the lens by 1.2 px rms, 4.0 px at worst (which the uncertainty "
            "includes), but fov fits it");
}

TEST(QueueEntry, QueueAndEntropyAreExplained) {
  expectSays(queue(0, ""), DiagnosticStatus::OK, "No segment of video is informative enough yet.");
  expectSays(queue(1, "accepted: the queue has room, and no segment overlaps"),
             DiagnosticStatus::OK,
             "The calibration rests on 1 segment of video, the queue. The newest segment: "
             "Accepted: the queue has room, and no segment overlaps.");
  expectSays(
      queue(20, "refused: entropy 3.12 (needed: 2.95, to replace the queue's worst segment)"),
      DiagnosticStatus::OK,
      "The calibration rests on 20 segments of video, the queue. The newest segment: Refused: "
      "entropy 3.12 (needed: 2.95, to replace the queue's worst segment). Entropy: how uncertain "
      "the lens would be by that segment alone; lower is better.");
}

TEST(TrackingEntry, AFrameThatIsMissingStandsBesideTheState) {
  FrameResult frame;
  frame.state = TrackingState::kTracking;
  frame.sentence = "following 120 features";
  Status status;
  judgeTracking(frame, "", &status);
  expectSays(status, DiagnosticStatus::OK, "Following 120 features.");
  judgeTracking(frame, "No transform goes out: base_link is not known.", &status);
  expectSays(status, DiagnosticStatus::ERROR,
             "Following 120 features. No transform goes out: base_link is not known.");
  frame.state = TrackingState::kLost;
  frame.sentence = "look at a place seen before";
  judgeTracking(frame, "", &status);
  expectSays(status, DiagnosticStatus::WARN, "LOST: Look at a place seen before.");
}

TEST(TimingEntry, TheMostUrgentIsSaid) {
  const auto judged = [](const InputCounts& now, std::int64_t dropped) {
    Status status;
    judgeTiming(now, InputCounts(), dropped, &status);
    return status;
  };
  InputCounts now;
  now.used = 30;
  expectSays(judged(now, 0), DiagnosticStatus::OK, "Keeps up with the camera.");
  now.missed = 2;
  expectSays(judged(now, 0), DiagnosticStatus::WARN,
             "2 images did not arrive since the last report: the camera or the network loses "
             "them.");
  expectSays(judged(now, 3), DiagnosticStatus::WARN,
             "Slower than the camera: 3 images were dropped since the last report. Lower the "
             "camera's rate or resolution, or max_features.");
  now.rejected = 1;
  now.last_problem = "the image is empty";
  expectSays(judged(now, 3), DiagnosticStatus::WARN, "Input: The image is empty.");
  now.used = 0;
  expectSays(judged(now, 3), DiagnosticStatus::ERROR, "Input: The image is empty.");
}

TEST(StorageEntry, WhatWasRefusedStandsBesideTheNewestSaving) {
  StorageStatus storage;
  storage.setKeeps(true);
  storage.setProblems({"the state file a is not used", "the calibration file b is not used"});
  storage.update({true, "saved to c"});
  Status status;
  storage.summarize(&status);
  expectSays(status, DiagnosticStatus::WARN,
             "Saved to c. The state file a is not used. The calibration file b is not used.");
  storage.update({false, "not saved: the disk is full"});
  storage.summarize(&status);
  expectSays(status, DiagnosticStatus::ERROR,
             "Not saved: the disk is full. The state file a is not used. The calibration file b is "
             "not used.");
}

TEST(RigEntry, StorageThatFailsStandsBesideTheVerdict) {
  RigReport report;
  report.state = CalibrationState::kConverged;
  report.sentence = "Camera 1 is turned by 1.20 degrees.";
  RigRemarks remarks;
  remarks.pair = "camera 1 is the left one: for stereo_image_proc, give its topic first";
  Status status;
  addVerdict(report, remarks, &status);
  expectSays(status, DiagnosticStatus::OK,
             "Camera 1 is turned by 1.20 degrees. Camera 1 is the left one: for stereo_image_proc, "
             "give its topic first.");
  remarks = {"No image of camera 0 for 3 s.", "not saved: the disk is full", ""};
  addVerdict(report, remarks, &status);
  expectSays(status, DiagnosticStatus::ERROR,
             "Camera 1 is turned by 1.20 degrees. No image of camera 0 for 3 s. Not saved: the "
             "disk is full.");
}

}  // namespace
}  // namespace camera_self_calibration
