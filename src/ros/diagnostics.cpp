#include "camera_self_calibration/ros/diagnostics.h"

#include <algorithm>

#include "camera_self_calibration/ros/diagnostic_entries.h"
#include "camera_self_calibration/ros/node_log.h"

namespace camera_self_calibration {

using diagnostic_msgs::DiagnosticStatus;

namespace {

constexpr double kSilence = 2.0;  // [s] From then on an old state is no news.

bool isOfTracking(EventType type) {
  return type == EventType::kLost || type == EventType::kRelocalized || type == EventType::kInput;
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
  carried_ += static_cast<std::int64_t>(result.tracks.carried.size());
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
  status.add("features left out, which moved with the camera", carried_);
  addEvent(tracking_event_, &status);
  if (silence() > kSilence) {
    status.summaryf(DiagnosticStatus::WARN, "No image for %.0f s: the pose is unknown.", silence());
    return;
  }
  judgeTracking(frame_, frame_problem_, &status);
}

void Diagnostics::calibration(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (addProblems(&status)) return;
  describeCalibration(report_, camera_info_->state(), calibration_event_, &status);
}

void Diagnostics::queue(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!addProblems(&status)) describeQueue(report_.queue, &status);
}

void Diagnostics::factory(Status& status) { describeFactory(factory_->audit(), &status); }

void Diagnostics::timing(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (addProblems(&status)) return;
  const ros::WallTime now = ros::WallTime::now();
  const double seconds = std::max(1e-3, (now - interval_begin_).toSec());
  const auto frames = static_cast<double>(interval_.frames);
  if (last_image_.isZero() || silence() > kSilence) {
    status.summary(DiagnosticStatus::WARN,
                   "No images on " + topic_ + ": is the camera running, and is the name right?");
  } else {
    judgeTiming(input_, interval_.before, dropped_ - interval_.dropped_before, &status);
  }
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

}  // namespace camera_self_calibration
