#include "camera_self_calibration/ros/control_services.h"

#include <exception>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/ros/camera_info.h"
#include "camera_self_calibration/ros/driver_commit.h"
#include "camera_self_calibration/ros/model_conversion.h"
#include "camera_self_calibration/ros/report_yaml.h"
#include "camera_self_calibration/ros/start_camera.h"

namespace camera_self_calibration {
namespace {

const char* const kNoImage = "no image has arrived yet";

/// Empty, or why there is a file that is not to be lost.
std::string whyNotReplaced(const std::string& report_file) {
  const FileContents present = readFile(report_file);
  if (!present.exists || (present.error.empty() && isReportYaml(present.bytes))) return "";
  return report_file +
         " exists and is no report of this node. It is left untouched: move it away, or set "
         "~report_file to another file.";
}

template <typename Response>
void answer(bool success, const std::string& message, Response* response) {
  response->success = success;
  response->message = message;
}

}  // namespace

ControlServices::ControlServices(const ros::NodeHandle& private_node, const ControlOptions& options,
                                 const ControlTargets& targets)
    : node_(private_node),
      options_(options),
      targets_(targets),
      autosave_interval_s_(options.autosave_interval_s) {
  node_.setCallbackQueue(&queue_);
  using Self = ControlServices;
  servers_ = {node_.advertiseService("reset", &Self::reset, this),
              node_.advertiseService("reset_tracking", &Self::resetTracking, this),
              node_.advertiseService("save", &Self::save, this),
              node_.advertiseService("commit", &Self::commit, this),
              node_.advertiseService("dump_report", &Self::dumpReport, this),
              node_.advertiseService("freeze", &Self::freeze, this),
              node_.advertiseService("set_camera_info", &Self::setCameraInfo, this),
              node_.advertiseService("set_scale", &Self::setScale, this)};
  timer_ = node_.createWallTimer(ros::WallDuration(1.0),
                                 [this](const ros::WallTimerEvent&) { autosave(false); });
  spinner_ = std::make_unique<ros::AsyncSpinner>(1, &queue_);
  spinner_->start();
}

ControlServices::~ControlServices() {
  timer_.stop();
  for (ros::ServiceServer& server : servers_) server.shutdown();
  spinner_->stop();
  autosave(true);
}

void ControlServices::setAutosaveInterval(double seconds) { autosave_interval_s_ = seconds; }

std::optional<ControlServices::Present> ControlServices::present() const {
  Present now;
  const bool running = targets_.with_calibrator([&now](SelfCalibrator& calibrator) {
    now = {calibrator.calibration(), calibrator.state(), calibrator.droppedImages()};
  });
  return running ? std::optional<Present>(now) : std::nullopt;
}

std::string ControlServices::whyNotConverged(const std::optional<Present>& now,
                                             const sensor_msgs::CameraInfo& info) const {
  if (!now) return kNoImage;
  if (now->report.state == CalibrationState::kConverged && now->state) {
    return isCalibrated(info) ? "" : kUncalibrated;
  }
  const std::string sentence =
      now->report.sentence.empty() ? "nothing is known yet" : now->report.sentence;
  return "the calibration is " + toString(now->report.state) + ", not CONVERGED: " + sentence;
}

void ControlServices::autosave(bool at_once) {
  const double interval = autosave_interval_s_;
  if (interval <= 0.0 || !targets_.store->hasFile()) return;
  if (!at_once && ros::WallTime::now() - last_save_ < ros::WallDuration(interval)) return;
  const std::optional<Present> now = present();
  const sensor_msgs::CameraInfo info = targets_.published_info();
  if (!whyNotConverged(now, info).empty() || now->state == saved_) return;
  // Where the newest segments disagree what was saved before may be the better one.
  if (!now->report.isGoodNow()) return;
  last_save_ = ros::WallTime::now();
  const CalibrationStore::Outcome outcome = saveTo(targets_.store, *now, info);
  // What cannot be saved is tried again after the interval and at the end, and said once.
  if (outcome.success) saved_ = now->state;
  if (!outcome.success && outcome.message != last_problem_) {
    ROS_WARN_STREAM(node_.getNamespace() << ": " << outcome.message);
  }
  last_problem_ = outcome.success ? "" : outcome.message;
}

CalibrationStore::Outcome ControlServices::saveTo(CalibrationStore* store, const Present& now,
                                                  const sensor_msgs::CameraInfo& info) {
  const CalibrationStore::Outcome outcome = store->save(*now.state, info);
  if (targets_.saved) targets_.saved(outcome);
  return outcome;
}

bool ControlServices::reset(Trigger::Request&, Trigger::Response& response) {
  std::string problem;
  // Not from the saved calibration, which the calibrator may have begun with.
  const bool done = targets_.with_calibrator([&](SelfCalibrator& calibrator) {
    const Camera now = calibrator.calibration().camera;
    if (now.width() > 0) calibrator.reset(unlearnt(now.width(), now.height(), &problem));
  });
  if (done) {
    targets_.camera_info->forget();
    targets_.sizes->forget();
    targets_.store->beginAnew();
  }
  if (!problem.empty()) ROS_WARN_STREAM(node_.getNamespace() << ": " << problem);
  answer(done,
         done ? "everything learnt is discarded; calibration starts again with the next image. "
                "Saved files "
                "stay until the calibration is CONVERGED again" +
                    (problem.empty() ? "" : ". " + problem)
              : kNoImage,
         &response);
  return true;
}

Camera ControlServices::unlearnt(int width, int height, std::string* problem) const {
  const CameraModel model = options_.pipeline.firstModel();
  const std::optional<Camera> given =
      startFromParameters(model, options_.initial_intrinsics, width, height, problem);
  return given ? *given : Camera::defaultGuess(model, width, height);
}

bool ControlServices::resetTracking(Trigger::Request&, Trigger::Response& response) {
  const bool done =
      targets_.with_calibrator([](SelfCalibrator& calibrator) { calibrator.resetTracking(); });
  answer(done, done ? "a new map begins with the next image; the calibration is kept" : kNoImage,
         &response);
  return true;
}

bool ControlServices::save(Trigger::Request&, Trigger::Response& response) {
  const std::optional<Present> now = present();
  const sensor_msgs::CameraInfo info = targets_.published_info();
  const std::string obstacle = whyNotConverged(now, info);
  if (!obstacle.empty()) {
    answer(false, "not saved: " + obstacle, &response);
    return true;
  }
  CalibrationStore* store = targets_.store->hasFile() || targets_.fallback_store == nullptr
                                ? targets_.store
                                : targets_.fallback_store;
  const CalibrationStore::Outcome outcome = saveTo(store, *now, info);
  if (outcome.success) saved_ = now->state;
  answer(outcome.success, outcome.message, &response);
  return true;
}

bool ControlServices::commit(Trigger::Request&, Trigger::Response& response) {
  const sensor_msgs::CameraInfo info = targets_.published_info();
  const std::string obstacle = whyNotConverged(present(), info);
  if (!obstacle.empty()) {
    answer(false, "not committed: " + obstacle, &response);
    return true;
  }
  const CommitOutcome outcome =
      commitToDriver(node_, options_.commit_service, info, options_.commit_timeout_s);
  answer(outcome.success, outcome.message, &response);
  return true;
}

bool ControlServices::dumpReport(Trigger::Request&, Trigger::Response& response) {
  const std::optional<Present> now = present();
  if (!now) {
    answer(false, kNoImage, &response);
    return true;
  }
  std::string error = whyNotReplaced(options_.report_file);
  if (error.empty()) {
    error = writeFileAtomically(options_.report_file, toYaml(now->report, now->dropped_images));
  }
  answer(error.empty(), error.empty() ? "report written to " + options_.report_file : error,
         &response);
  return true;
}

bool ControlServices::freeze(std_srvs::SetBool::Request& request,
                             std_srvs::SetBool::Response& response) {
  bool done = false;
  const bool running = targets_.with_calibrator(
      [&](SelfCalibrator& calibrator) { done = calibrator.freeze(request.data); });
  if (!running) {
    answer(false, kNoImage, &response);
  } else if (!done) {
    answer(false, "there is no calibration to keep yet", &response);
  } else {
    answer(true,
           request.data ? "the calibration is kept as it is; tracking goes on"
                        : "the calibration is updated again",
           &response);
  }
  return true;
}

bool ControlServices::setCameraInfo(sensor_msgs::SetCameraInfo::Request& request,
                                    sensor_msgs::SetCameraInfo::Response& response) {
  const sensor_msgs::CameraInfo& info = request.camera_info;
  std::string problem;
  const bool running = targets_.with_calibrator([&](SelfCalibrator& calibrator) {
    const Camera now = calibrator.calibration().camera;
    const auto width = static_cast<int>(info.width);
    const auto height = static_cast<int>(info.height);
    const std::optional<CameraFit> start = startFrom(info, options_.pipeline.model);
    if (now.width() > 0 && width > 0 && (now.width() != width || now.height() != height)) {
      problem = "it is for images of " + sizeText(width, height) + ", these are " +
                sizeText(now.width(), now.height());
    } else if (!start) {
      problem = whyNoStart(info, options_.pipeline.model);
    } else {
      targets_.camera_info->accept(start->camera, info);
      calibrator.reset(start->camera);
    }
  });
  if (!running) problem = kNoImage;
  response.success = problem.empty();
  if (!response.success) {
    response.status_message = "The calibration is not used: " + problem + ".";
    return true;
  }
  targets_.sizes->forget();
  targets_.store->beginAnew();
  const CalibrationStore::Outcome saving = targets_.store->saveGiven(options_.pipeline.model, info);
  if (targets_.saved && targets_.store->hasFile()) targets_.saved(saving);
  response.status_message =
      "The calibration is in use at once, and the images refine it from now on. " +
      asSentence(saving.message);
  return true;
}

bool ControlServices::setScale(SetScale::Request& request, SetScale::Response& response) {
  bool done = false;
  const bool running = targets_.with_calibrator(
      [&](SelfCalibrator& calibrator) { done = calibrator.setScale(request.factor); });
  std::string message = "lengths are multiplied from the next image on, with a new map_id";
  if (!running) {
    message = kNoImage;
  } else if (!done) {
    message = SelfCalibrator::isScaleFactor(request.factor)
                  ? "the camera is not being tracked: there is no map to scale"
                  : "the factor must lie between 1e-6 and 1e6";
  }
  answer(done, message, &response);
  return true;
}

}  // namespace camera_self_calibration
