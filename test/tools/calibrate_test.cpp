// What calibrate() makes of the state at the end of a recording.

#include "camera_self_calibration/tools/calibrate.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/tools/bag_state.h"
#include "camera_self_calibration/tools/report_text.h"
#include "queue/sample_queues.h"
#include "tools/temporary_folder.h"

namespace camera_self_calibration {
namespace {

const Camera kLens = camera640(CameraModel::kPinhole, {420, 418, 322, 238});

/// The report of a calibration that was CONVERGED before.
CalibrationReport liveReport(double rms) {
  HealthEvidence evidence;
  evidence.keyframes = 40;
  evidence.has_estimate = evidence.handed_over = true;
  evidence.information = IntrinsicsMatrix::Identity(4, 4);
  evidence.information(0, 0) = 1.0 / 400.0;  // fx is known least
  evidence.uncertainty = {rms, 3.0 * rms};
  evidence.threshold_px = 1.0;
  const HealthVerdict verdict = judgeHealth(evidence, kLens, CalibrationState::kConverged);
  const HealthVerdict afresh = judgeHealth(evidence, kLens, CalibrationState::kConverging);
  CalibrationReport report;
  report.state = verdict.state;
  report.sentence = verdict.sentence;
  report.hint = verdict.hint;
  if (afresh.state != verdict.state) report.afresh = afresh;
  report.camera = kLens;
  report.covariance = evidence.information.inverse();
  report.uncertainty = evidence.uncertainty;
  report.handed_over = true;
  return report;
}

TEST(AtTheEnd, ConvergedMeansWithinTheLimit) {
  const CalibrationReport live = liveReport(1.41);
  ASSERT_EQ(live.state, CalibrationState::kConverged) << "kept beyond the limit";
  const CalibrationReport end = atTheEnd(live);
  EXPECT_EQ(end.state, CalibrationState::kConverging);
  EXPECT_NE(end.sentence.find("good to 1.41 px rms over the image (needed: 1.00 px)"),
            std::string::npos)
      << end.sentence;
  EXPECT_FALSE(end.hint.empty());
  EXPECT_EQ(end.uncertainty.rms, 1.41);
  EXPECT_FALSE(end.afresh);
}

TEST(AtTheEnd, OtherVerdictsStayAsTheyAre) {
  for (const double rms : {0.3, 1.0, 1.6}) {
    const CalibrationReport live = liveReport(rms);
    const CalibrationReport end = atTheEnd(live);
    EXPECT_EQ(end.state, live.state) << rms;
    EXPECT_EQ(end.sentence, live.sentence) << rms;
    EXPECT_EQ(end.hint, live.hint) << rms;
  }
}

/// A run that ended so, and learnt what these segments tell.
Recording recordingThatEnded(const CalibrationReport& live) {
  const SegmentQueue queue = solvedQueue(separateSegments(kLens, 3, 50), kLens);
  LearntState learnt;
  learnt.camera = queue.solution().camera;
  learnt.state = live.state;
  learnt.segments = queue.candidates();
  Recording recording;
  recording.frames = 300;
  recording.processing_seconds = 10.0;
  recording.reports = {live};
  recording.final_report = atTheEnd(live);
  recording.learnt = std::make_shared<LearntState>(learnt);
  return recording;
}

TEST(Recording, SaysWhatMovedWithTheCamera) {
  Recording recording = recordingThatEnded(liveReport(0.5));
  EXPECT_EQ(reportText(recording).find("moved with the camera"), std::string::npos);
  EXPECT_EQ(summaryJson(recording)["carried_features"], 0);
  recording.carried = 57;
  EXPECT_NE(reportText(recording).find("57 features moved with the camera"), std::string::npos);
  for (const char* losses : {"never lost", "lost once", "lost 2 times"}) {
    const std::string sentence = "a pose for " + std::to_string(recording.poses.size()) + " of " +
                                 std::to_string(recording.frames) + " images; tracking was ";
    EXPECT_NE(reportText(recording).find(sentence + losses + "\n"), std::string::npos) << losses;
    recording.events.push_back({EventType::kLost, 1, 1, "tracking was lost"});
  }
  EXPECT_EQ(summaryJson(recording)["carried_features"], 57);
}

TEST(AtTheEnd, TerminalFilesAndStateAgree) {
  const TemporaryFolder folder;
  for (const double rms : {0.5, 1.41}) {
    const Recording recording = recordingThatEnded(liveReport(rms));
    const bool good = rms < 1.0;
    const CalibrationState state =
        good ? CalibrationState::kConverged : CalibrationState::kConverging;
    EXPECT_EQ(reportText(recording).find(toString(state) + ": "), 0u) << reportText(recording);
    EXPECT_EQ(summaryJson(recording)["state"], toString(state));
    writeRecording(folder.string(), "camera", recording);
    EXPECT_EQ(std::filesystem::exists(folder / "calibration.yaml"), good);
    EXPECT_EQ(std::filesystem::exists(folder / "camchain.yaml"), good);
    const auto learnt = stateOfBag(recording, "day.bag", "front");
    ASSERT_TRUE(learnt);
    EXPECT_EQ(learnt->state, state) << "what calibrate_bag exits with when it is run again";
    ASSERT_EQ(learnt->bags.size(), 1u);
    EXPECT_EQ(learnt->bags[0].state, state);
  }
}

}  // namespace
}  // namespace camera_self_calibration
