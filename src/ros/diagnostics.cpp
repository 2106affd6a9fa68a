#include "camera_self_calibration/ros/diagnostics.h"

#include <algorithm>

namespace camera_self_calibration {

using diagnostic_msgs::DiagnosticStatus;

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
  problems_.clear();
  for (const std::string& problem : problems) {
    problems_ += (problems_.empty() ? "" : "; ") + problem;
  }
}

void Diagnostics::setStorageProblems(const std::vector<std::string>& problems) {
  const std::lock_guard<std::mutex> lock(mutex_);
  storage_problems_.clear();
  for (const std::string& problem : problems) {
    storage_problems_ += (storage_problems_.empty() ? "" : "; ") + problem;
  }
}

void Diagnostics::storage(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (addProblems(&status)) return;
  if (storage_problems_.empty()) {
    status.summary(DiagnosticStatus::OK, "Nothing is wrong with the saved files.");
  } else {
    status.summary(DiagnosticStatus::WARN, storage_problems_);
  }
}

void Diagnostics::setTopic(const std::string& topic) {
  updater_.setHardwareID(topic);
  const std::lock_guard<std::mutex> lock(mutex_);
  topic_ = topic;
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
}

void Diagnostics::publish() { updater_.force_update(); }

bool Diagnostics::addProblems(Status* status) const {
  if (problems_.empty()) return false;
  status->summary(DiagnosticStatus::ERROR, "Idle, the parameters cannot be used: " + problems_);
  return true;
}

void Diagnostics::tracking(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (addProblems(&status)) return;
  if (input_.used == 0) {
    status.summary(DiagnosticStatus::WARN, "No image has come yet.");
    return;
  }
  const bool tracking = frame_.state == TrackingState::kTracking;
  status.summary(tracking ? DiagnosticStatus::OK : DiagnosticStatus::WARN, frame_.sentence);
  status.add("state", toString(frame_.state));
  status.add("map_id", frame_.map_id);
  status.add("tracks", frame_.tracks.tracks.size());
}

void Diagnostics::calibration(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (addProblems(&status)) return;
  const bool converged = report_.state == CalibrationState::kConverged;
  std::string sentence = report_.sentence.empty() ? "Nothing is known yet." : report_.sentence;
  if (!report_.hint.empty()) sentence += " " + report_.hint;
  status.summary(converged ? DiagnosticStatus::OK : DiagnosticStatus::WARN, sentence);
  status.add("state", toString(report_.state));
  status.add("pixel uncertainty rms [px]", report_.uncertainty.rms);
  status.add("pixel uncertainty max [px]", report_.uncertainty.max);
  status.add("revision", report_.revision);
  status.add("epoch", report_.epoch);
  if (!report_.last_change.empty()) status.add("last change", report_.last_change);
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
                         "camera_info goes out, rescaled from the former image size.");
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
  status.summary(DiagnosticStatus::OK,
                 std::to_string(queue.segments.size()) + " segments. Last candidate: " +
                     (queue.last_decision.empty() ? "none yet" : queue.last_decision));
  status.add("segments", queue.segments.size());
  status.add("swaps", queue.swaps);
  status.add("last_accepted", queue.last_accepted);
}

void Diagnostics::factory(Status& status) {
  const FactoryComparison comparison = factory_->comparison();
  const bool fine = comparison.verdict == FactoryVerdict::kAgrees ||
                    comparison.verdict == FactoryVerdict::kWaiting;
  status.summary(fine ? DiagnosticStatus::OK : DiagnosticStatus::WARN, comparison.sentence);
  if (comparison.verdict != FactoryVerdict::kAgrees &&
      comparison.verdict != FactoryVerdict::kDiffers) {
    return;
  }
  status.add("difference rms [px]", comparison.distance.rms);
  status.add("difference max [px]", comparison.distance.max);
}

void Diagnostics::timing(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (addProblems(&status)) return;
  const ros::WallTime now = ros::WallTime::now();
  const double seconds = std::max(1e-3, (now - interval_begin_).toSec());
  const auto frames = static_cast<double>(interval_.frames);
  const std::int64_t new_drops = dropped_ - interval_.dropped_before;
  const std::int64_t new_rejects = input_.rejected - interval_.rejected_before;
  const std::int64_t new_jumps = input_.jumps - interval_.jumps_before;
  status.summary(DiagnosticStatus::OK, "Keeps up with the camera.");
  if (interval_.frames == 0 && new_rejects == 0) {
    status.summary(DiagnosticStatus::WARN,
                   "No images on " + topic_ + "; is the camera running and the name right?");
  } else if (new_rejects > 0 || new_jumps > 0) {
    status.summary(DiagnosticStatus::WARN, "Input: " + input_.last_problem + ".");
  } else if (new_drops > 0) {
    status.summary(DiagnosticStatus::WARN,
                   "Slower than the camera: images are dropped. Lower the rate or max_features.");
  }
  status.add("rate [Hz]", frames / seconds);
  status.add("processing mean [ms]", frames > 0 ? 1e3 * interval_.seconds_sum / frames : 0.0);
  status.add("processing max [ms]", 1e3 * interval_.seconds_max);
  status.add("images dropped", dropped_);
  status.add("images rejected", input_.rejected);
  status.add("clock jumps", input_.jumps);
  interval_ = Interval();
  interval_.dropped_before = dropped_;
  interval_.rejected_before = input_.rejected;
  interval_.jumps_before = input_.jumps;
  interval_begin_ = now;
}

}  // namespace camera_self_calibration
