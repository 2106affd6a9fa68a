#include "camera_self_calibration/ros/diagnostics.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/ros/node_log.h"

namespace camera_self_calibration {

using diagnostic_msgs::DiagnosticStatus;

namespace {

constexpr double kSilence = 2.0;  // [s] From then on an old state is no news.

bool isOfTracking(EventType type) {
  return type == EventType::kLost || type == EventType::kRelocalized || type == EventType::kInput;
}

/// For those who have not read the manual.
std::string meaningOf(EventType type) {
  switch (type) {
    case EventType::kHandover:
      return " (HANDOVER: startup is over. From now on only the most informative segments are "
             "kept.)";
    case EventType::kConverged:
      return " (CONVERGED: the calibration is good enough for use, and camera_info is published.)";
    case EventType::kCalibrationChange:
      return " (CALIBRATION_CHANGE: the lens was bumped, refocused or zoomed.)";
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

void addEvent(const std::optional<Event>& event,
              diagnostic_updater::DiagnosticStatusWrapper* status) {
  if (!event) return;
  const std::string stamp = formatted(" at %.3f s: ", toSeconds(event->stamp_ns));
  status->add("last event",
              toString(event->type) + stamp + asSentence(event->sentence) + meaningOf(event->type));
}

}  // namespace

Diagnostics::Diagnostics(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                         const std::string& name, const CameraInfoPolicy* camera_info)
    : updater_(node, private_node, name), camera_info_(camera_info) {
  updater_.setHardwareID("none");
  updater_.add("tracking", this, &Diagnostics::tracking);
  updater_.add("calibration", this, &Diagnostics::calibration);
  updater_.add("queue", this, &Diagnostics::queue);
  updater_.add("timing", this, &Diagnostics::timing);
  updater_.add("storage", this, &Diagnostics::storage);
}

void Diagnostics::setProblems(const std::vector<std::string>& problems) {
  const std::lock_guard<std::mutex> lock(mutex_);
  idle_ = idleSentence(problems);
}

void Diagnostics::setStorageProblems(const std::vector<std::string>& problems) {
  const std::lock_guard<std::mutex> lock(mutex_);
  storage_.setProblems(problems);
}

void Diagnostics::setKeeps(bool keeps) {
  const std::lock_guard<std::mutex> lock(mutex_);
  storage_.setKeeps(keeps);
}

void Diagnostics::update(const CalibrationStore::Outcome& saving) {
  const std::lock_guard<std::mutex> lock(mutex_);
  storage_.update(saving);
}

void Diagnostics::storage(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!addProblems(&status)) storage_.summarize(&status);
}

void Diagnostics::setTopic(const std::string& topic) {
  updater_.setHardwareID(topic);
  const std::lock_guard<std::mutex> lock(mutex_);
  topic_ = topic;
}

void Diagnostics::setFrameProblem(const std::string& problem) {
  const std::lock_guard<std::mutex> lock(mutex_);
  frame_problem_ = problem;
}

void Diagnostics::watch(const FactoryCalibration* factory_calibration) {
  factory_ = factory_calibration;
  updater_.add("factory calibration", this, &Diagnostics::factory);
}

void Diagnostics::update(const FrameResult& result, std::int64_t dropped_images) {
  const std::lock_guard<std::mutex> lock(mutex_);
  frame_ = result;
  dropped_ = dropped_images;
  ++interval_.frames;
  interval_.seconds_sum += result.processing_seconds;
  interval_.seconds_max = std::max(interval_.seconds_max, result.processing_seconds);
}

void Diagnostics::update(const CalibrationReport& report) {
  const std::lock_guard<std::mutex> lock(mutex_);
  report_ = report;
}

void Diagnostics::update(const InputCounts& input) {
  const std::lock_guard<std::mutex> lock(mutex_);
  input_ = input;
  last_image_ = ros::WallTime::now();
}

void Diagnostics::update(const Event& event) {
  const std::lock_guard<std::mutex> lock(mutex_);
  (isOfTracking(event.type) ? tracking_event_ : calibration_event_) = event;
  losses_ += event.type == EventType::kLost;
}

void Diagnostics::publish() { updater_.force_update(); }

bool Diagnostics::addProblems(Status* status) const {
  if (idle_.empty()) return false;
  status->summary(DiagnosticStatus::ERROR, idle_);
  return true;
}

double Diagnostics::silence() const { return (ros::WallTime::now() - last_image_).toSec(); }

void Diagnostics::tracking(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (addProblems(&status)) return;
  if (last_image_.isZero()) {
    status.summary(DiagnosticStatus::WARN, "No image has come yet on " + topic_ +
                                               ": is the camera running, and is the name right?");
    return;
  }
  status.add("state", toString(frame_.state));
  status.add("map_id", frame_.map_id);
  status.add("tracks", frame_.tracks.tracks.size());
  status.add("losses", losses_);
  addEvent(tracking_event_, &status);
  if (silence() > kSilence) {
    status.summaryf(DiagnosticStatus::WARN, "No image for %.0f s: the pose is unknown.", silence());
    return;
  }
  const bool tracking = frame_.state == TrackingState::kTracking;
  const std::string name = tracking ? "" : toString(frame_.state) + ": ";
  status.summary(tracking ? DiagnosticStatus::OK : DiagnosticStatus::WARN,
                 name + asSentence(frame_.sentence));
  if (!frame_problem_.empty()) status.mergeSummary(DiagnosticStatus::ERROR, frame_problem_);
}

void Diagnostics::calibration(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (addProblems(&status)) return;
  const bool converged = report_.state == CalibrationState::kConverged;
  std::string sentence =
      report_.sentence.empty() ? "Nothing is known yet." : asSentence(report_.sentence);
  if (!report_.hint.empty()) sentence += " " + asSentence(report_.hint);
  status.summary(converged ? DiagnosticStatus::OK : DiagnosticStatus::WARN, sentence);
  status.add("state", toString(report_.state));
  status.add("pixel uncertainty rms [px]", report_.uncertainty.rms);
  status.add("pixel uncertainty max [px]", report_.uncertainty.max);
  if (report_.observed.share > 0.0) {
    status.add("image covered by features [%]", 100.0 * report_.observed.share);
    status.add("pixel uncertainty rms there [px]", report_.observed.uncertainty.rms);
  }
  if (report_.cross_validation.compared) {
    status.add("two halves of the video", report_.cross_validation.sentence());
  }
  if (report_.lens_fit.compared) status.add("lens fit", report_.lens_fit.sentence());
  status.add("shutter", describe(report_.shutter));
  status.add("revision", report_.revision);
  status.add("epoch", report_.epoch);
  if (!report_.last_change.empty()) status.add("last change", report_.last_change);
  addEvent(calibration_event_, &status);
  addCameraInfo(&status);
}

void Diagnostics::addCameraInfo(Status* status) const {
  const CameraInfoState info = camera_info_->state();
  if (!info.obstacle.empty()) status->mergeSummary(DiagnosticStatus::ERROR, info.obstacle);
  if (info.distortion_model.empty()) {
    status->add("camera_info", "zeros: not calibrated");
    return;
  }
  status->add("camera_info", info.distortion_model);
  status->add("camera_info conversion error rms [px]", info.error.rms);
  status->add("camera_info conversion error max [px]", info.error.max);
  if (info.inherited) {
    status->mergeSummary(DiagnosticStatus::OK,
                         "camera_info is the calibration of the former image size, rescaled.");
  }
  if (info.given) {
    status->mergeSummary(DiagnosticStatus::OK,
                         "camera_info is the one from set_camera_info, until the images "
                         "confirm or replace it.");
  }
  if (info.last_good) {
    status->mergeSummary(DiagnosticStatus::WARN,
                         "The calibration is no longer CONVERGED; camera_info still carries the "
                         "last one that was.");
  }
  if (info.error.max > CameraInfoPolicy::kConversionWarning) {
    status->mergeSummaryf(DiagnosticStatus::WARN,
                          "The published %s deviates from the estimated lens by up to %.2f px; "
                          "another output_distortion_model may be closer.",
                          info.distortion_model.c_str(), info.error.max);
  }
}

void Diagnostics::queue(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (addProblems(&status)) return;
  const QueueReport& queue = report_.queue;
  const std::size_t segments = queue.segments.size();
  std::string last;
  if (!queue.last_decision.empty()) {
    last = " The newest segment: " + asSentence(queue.last_decision);
    const bool scored = queue.last_decision.find("entropy") != std::string::npos;
    if (scored) last += " (The lower its entropy, the more informative a segment is.)";
  }
  if (segments == 0) {
    status.summary(DiagnosticStatus::OK, "No segment of video is informative enough yet." + last);
  } else {
    status.summary(DiagnosticStatus::OK, "The calibration rests on " + std::to_string(segments) +
                                             (segments == 1 ? " segment" : " segments") +
                                             " of video." + last);
  }
  status.add("segments", queue.segments.size());
  status.add("swaps", queue.swaps);
  status.add("last_accepted", queue.last_accepted);
}

void Diagnostics::factory(Status& status) {
  const FactoryAudit factory = factory_->audit();
  const AuditReport& audit = factory.audit;
  const bool fine = factory.usable && audit.verdict != AuditVerdict::kWrong;
  status.summary(fine ? DiagnosticStatus::OK : DiagnosticStatus::WARN, factory.sentence);
  if (!factory.usable) return;
  status.add("verdict", toString(audit.verdict));
  if (!std::isfinite(audit.distance_px)) return;
  status.add("distance rms [px]", audit.distance_px);
  status.add("its sigma [px]", audit.sigma_px);
  status.add("p-value", audit.p_value);
  if (audit.verdict == AuditVerdict::kWrong) status.add("likely cause", audit.cause_sentence);
}

void Diagnostics::timing(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (addProblems(&status)) return;
  const ros::WallTime now = ros::WallTime::now();
  const double seconds = std::max(1e-3, (now - interval_begin_).toSec());
  const auto frames = static_cast<double>(interval_.frames);
  summarizeTiming(&status);
  status.add("camera rate [Hz]", input_.rate_hz);
  status.add("processed rate [Hz]", frames / seconds);
  status.add("processing mean [ms]", frames > 0 ? 1e3 * interval_.seconds_sum / frames : 0.0);
  status.add("processing max [ms]", 1e3 * interval_.seconds_max);
  status.add("images dropped, processing too slow", dropped_);
  status.add("images missed, lost before they came here", input_.missed);
  status.add("images rejected", input_.rejected);
  status.add("clock jumps", input_.jumps);
  status.add("gaps", input_.gaps);
  status.add("size changes", input_.size_changes);
  interval_ = Interval();
  interval_.dropped_before = dropped_;
  interval_.before = input_;
  interval_begin_ = now;
}

// The most urgent first: what an operator has to do something about.
void Diagnostics::summarizeTiming(Status* status) const {
  const InputCounts& before = interval_.before;
  const std::int64_t drops = dropped_ - interval_.dropped_before;
  const std::int64_t missed = input_.missed - before.missed;
  const bool heard = input_.used > before.used;
  if (last_image_.isZero() || silence() > kSilence) {
    status->summary(DiagnosticStatus::WARN,
                    "No images on " + topic_ + ": is the camera running, and is the name right?");
  } else if (input_.rejected > before.rejected || input_.jumps > before.jumps) {
    status->summary(heard ? DiagnosticStatus::WARN : DiagnosticStatus::ERROR,
                    "Input: " + asSentence(input_.last_problem));
  } else if (drops > 0) {
    status->summaryf(DiagnosticStatus::WARN,
                     "Slower than the camera: %lld images were dropped since the last report. "
                     "Lower the camera's rate or resolution, or max_features.",
                     static_cast<long long>(drops));
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
