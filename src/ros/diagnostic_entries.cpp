#include "camera_self_calibration/ros/diagnostic_entries.h"

#include <cmath>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/ros/judgement.h"

namespace camera_self_calibration {

using diagnostic_msgs::DiagnosticStatus;
using Status = diagnostic_updater::DiagnosticStatusWrapper;

namespace {

/// For those who have not read the manual.
std::string meaningOf(EventType type) {
  switch (type) {
    case EventType::kHandover:
      return " (HANDOVER: the queue of the most informative segments gives the calibration from "
             "now on.)";
    case EventType::kConverged:
      return " (CONVERGED: the calibration is good enough for use, and camera_info is published.)";
    case EventType::kNoLongerConverged:
      return " (NO_LONGER_CONVERGED: the calibration is not good enough for use any more.)";
    case EventType::kCalibrationChange:
      return " (CALIBRATION_CHANGE: the images no longer fit the calibration that was in use, as "
             "after a bump, a zoom or a new focus.)";
    case EventType::kMountChanged:
      return " (MOUNT_CHANGED: a camera was turned or moved against the others.)";
    case EventType::kRelocalized:
      return " (RELOCALIZED: a place of an earlier map was recognised.)";
    case EventType::kLost:
    case EventType::kInput:
      return "";
  }
  return "";
}

void describeCameraInfo(const CameraInfoState& info, Status* status) {
  addJudgement(DiagnosticStatus::ERROR, info.obstacle, status);
  if (info.distortion_model.empty()) {
    status->add("camera_info", "zeros: not calibrated");
    return;
  }
  status->add("camera_info", info.distortion_model);
  status->add("camera_info conversion error rms [px]", info.error.rms);
  status->add("camera_info conversion error max [px]", info.error.max);
  if (info.inherited) {
    addJudgement(DiagnosticStatus::OK,
                 "camera_info is what was known before the images changed, until they confirm or "
                 "replace it.",
                 status);
  }
  if (info.given) {
    addJudgement(DiagnosticStatus::OK,
                 "camera_info is the one from set_camera_info, until the images confirm or "
                 "replace it.",
                 status);
  }
  if (info.last_good) {
    addJudgement(DiagnosticStatus::WARN,
                 "The calibration is no longer CONVERGED; camera_info still carries the last one "
                 "that was.",
                 status);
  }
  addJudgement(DiagnosticStatus::WARN, info.deviation, status);
}

/// What became of the newest segment, with the words of the estimator explained.
std::string newestSegment(const std::string& decision) {
  if (decision.empty()) return {};
  const bool scored = decision.find("entropy") != std::string::npos;
  const std::string entropy =
      " Entropy: how uncertain the lens would be by that segment alone; lower is better.";
  return "The newest segment: " + asSentence(decision) + (scored ? entropy : "");
}

}  // namespace

void addEvent(const std::optional<Event>& event, Status* status) {
  if (!event) return;
  const std::string stamp = formatted(" at %.3f s: ", toSeconds(event->stamp_ns));
  status->add("last event",
              toString(event->type) + stamp + asSentence(event->sentence) + meaningOf(event->type));
}

void judgeTracking(const FrameResult& frame, const std::string& frame_problem, Status* status) {
  const bool tracking = frame.state == TrackingState::kTracking;
  const std::string name = tracking ? "" : toString(frame.state) + ": ";
  status->summary(tracking ? DiagnosticStatus::OK : DiagnosticStatus::WARN,
                  name + asSentence(frame.sentence));
  addJudgement(DiagnosticStatus::ERROR, frame_problem, status);
}

void describeCalibration(const CalibrationReport& report, const CameraInfoState& info,
                         const std::optional<Event>& event, Status* status) {
  const bool converged = report.state == CalibrationState::kConverged;
  status->summary(converged ? DiagnosticStatus::OK : DiagnosticStatus::WARN,
                  sentencesOf(report.sentence.empty() ? "Nothing is known yet." : report.sentence,
                              report.hint));
  status->add("state", toString(report.state));
  status->add("pixel uncertainty rms [px]", report.uncertainty.rms);
  status->add("pixel uncertainty max [px]", report.uncertainty.max);
  if (report.observed.share > 0.0) {
    status->add("image covered by features [%]", 100.0 * report.observed.share);
    status->add("pixel uncertainty rms there [px]", report.observed.uncertainty.rms);
  }
  if (report.cross_validation.compared) {
    status->add("two parts of the video", report.cross_validation.sentence());
  }
  if (report.lens_fit.compared) status->add("lens fit", report.lens_fit.sentence());
  status->add("shutter", describe(report.shutter));
  status->add("revision", report.revision);
  status->add("epoch", report.epoch);
  if (!report.last_change.empty()) status->add("last change", report.last_change);
  addEvent(event, status);
  describeCameraInfo(info, status);
}

void describeQueue(const QueueReport& queue, Status* status) {
  const std::size_t segments = queue.segments.size();
  status->summary(DiagnosticStatus::OK,
                  segments == 0 ? "No segment of video is informative enough yet."
                                : formatted("The calibration rests on %zu segment%s of video, the "
                                            "queue.",
                                            segments, segments == 1 ? "" : "s"));
  addJudgement(DiagnosticStatus::OK, newestSegment(queue.last_decision), status);
  status->add("segments", segments);
  status->add("swaps", queue.swaps);
  status->add("last_accepted", queue.last_accepted);
}

void describeFactory(const FactoryAudit& factory, Status* status) {
  const AuditReport& audit = factory.audit;
  const bool fine = factory.usable && audit.verdict != AuditVerdict::kWrong;
  status->summary(fine ? DiagnosticStatus::OK : DiagnosticStatus::WARN, factory.sentence);
  if (!factory.usable) return;
  status->add("verdict", toString(audit.verdict));
  if (!std::isfinite(audit.distance_px)) return;
  status->add("distance rms [px]", audit.distance_px);
  status->add("its sigma [px]", audit.sigma_px);
  status->add("p-value", audit.p_value);
  if (audit.verdict == AuditVerdict::kWrong) status->add("likely cause", audit.cause_sentence);
}

// The most urgent first: what an operator has to do something about.
void judgeTiming(const InputCounts& now, const InputCounts& before, std::int64_t dropped,
                 Status* status) {
  const std::int64_t missed = now.missed - before.missed;
  if (now.rejected > before.rejected || now.jumps > before.jumps) {
    status->summary(now.used > before.used ? DiagnosticStatus::WARN : DiagnosticStatus::ERROR,
                    "Input: " + asSentence(now.last_problem));
  } else if (dropped > 0) {
    status->summaryf(DiagnosticStatus::WARN,
                     "Slower than the camera: %lld images were dropped since the last report. "
                     "Lower the camera's rate or resolution, or max_features.",
                     static_cast<long long>(dropped));
  } else if (missed > 0) {
    status->summaryf(DiagnosticStatus::WARN,
                     "%lld images did not arrive since the last report: the camera or the network "
                     "loses them.",
                     static_cast<long long>(missed));
  } else {
    status->summary(DiagnosticStatus::OK, "Keeps up with the camera.");
  }
}

}  // namespace camera_self_calibration
