#include "camera_self_calibration/rig_node/rig_calibration_node.h"

#include <camera_self_calibration/CalibrationEvent.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/TransformStamped.h>

#include <utility>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/rig_node/rig_judgement.h"
#include "camera_self_calibration/ros/frame_names.h"
#include "camera_self_calibration/ros/messages.h"
#include "camera_self_calibration/ros/stamps.h"

namespace camera_self_calibration {
namespace {

using diagnostic_msgs::DiagnosticStatus;

constexpr double kSilence = 2.0;     // [s]
constexpr double kSaveAgain = 10.0;  // [s] after it failed

std::string cameraText(const RigNodeOptions& options, int camera) {
  return formatted("camera %d (%s)", camera, options.image_topics[camera].c_str());
}

}  // namespace

RigCalibrationNode::RigCalibrationNode(const ros::NodeHandle& node,
                                       const ros::NodeHandle& private_node, const std::string& name)
    : node_(node),
      private_node_(private_node),
      log_(private_node.getNamespace()),
      updater_(node, private_node, name) {
  RigNodeOptionsReading reading = readRigNodeOptions(private_node_);
  options_ = std::move(reading.options);
  for (std::string& topic : options_.image_topics) topic = node_.resolveName(topic);
  updater_.setHardwareID("none");
  updater_.add("rig", this, &RigCalibrationNode::describe);
  timer_ = private_node_.createWallTimer(
      ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { updater_.force_update(); });
  for (const std::string& warning : reading.warnings) log_.warn(warning);
  if (reading.problems.empty()) {
    start(name);
  } else {
    idle_ = idleSentence(reading.problems);
    log_.idle(reading.problems);
  }
}

void RigCalibrationNode::start(const std::string& name) {
  CameraInfoOptions info;
  info.min_change_px = options_.camera.min_publish_change_px;
  info.publish_uncalibrated = options_.camera.publish_uncalibrated;
  camera_info_ =
      std::make_unique<RigCameraInfo>(info, options_.camera.pipeline, options_.cameras());
  store_ = std::make_unique<RigStore>(options_, name, false);
  fallback_store_ = std::make_unique<RigStore>(options_, name, true);
  event_ = private_node_.advertise<CalibrationEvent>("event", 10);
  if (options_.publish_tf) {
    transforms_ = std::make_unique<tf2_ros::StaticTransformBroadcaster>();
  }
  for (int c = 0; c < options_.cameras(); ++c) addPort(c);
  RigCallbacks callbacks;
  callbacks.event = [this](int camera, const Event& event) {
    raise(withCameraInfo(event, camera_info_->state(camera)),
          event.type == EventType::kMountChanged ? "the rig" : cameraText(options_, camera));
  };
  callbacks.rig = [this](const RigReport& report) { onReport(report); };
  calibrator_ = std::make_unique<RigSelfCalibrator>(
      options_.rig(), std::vector<Options>(ports_.size(), options_.camera.pipeline),
      SelfCalibrator::Mode::kThreaded, callbacks);
  loadRig();
  ros::NodeHandle services(private_node_);
  services.setCallbackQueue(&service_queue_);
  save_ = services.advertiseService("save", &RigCalibrationNode::save, this);
  save_timer_ = services.createWallTimer(ros::WallDuration(kSaveAgain),
                                         [this](const ros::WallTimerEvent&) { saveAgain(); });
  service_spinner_ = std::make_unique<ros::AsyncSpinner>(1, &service_queue_);
  service_spinner_->start();
  for (const auto& port : ports_) port->input->subscribe();
}

RigCalibrationNode::~RigCalibrationNode() {
  for (const auto& port : ports_) port->input->shutdown();
  timer_.stop();
  save_timer_.stop();
  save_.shutdown();
  if (service_spinner_) service_spinner_->stop();
  if (calibrator_) saveAgain();
  {
    const std::lock_guard<std::mutex> lock(report_mutex_);
    closing_ = true;
  }
  calibrator_.reset();
}

void RigCalibrationNode::addPort(int camera) {
  auto port = std::make_unique<Port>();
  port->monitor.keepSize();
  ros::NodeHandle names(private_node_, options_.camera_names[camera]);
  port->input = std::make_unique<ImageInput>(
      node_, options_.image_topics[camera], options_.camera.image_transport,
      [this, camera](const InputImage& image) { onImage(camera, image); });
  port->publisher = std::make_unique<CameraPublisher>(
      names, [this, camera](const std_msgs::Header& header, int width, int height) {
        return camera_info_->infoFor(camera, header, width, height);
      });
  port->extrinsics =
      names.advertise<geometry_msgs::PoseWithCovarianceStamped>("extrinsics", 1, true);
  ports_.push_back(std::move(port));
}

void RigCalibrationNode::loadRig() {
  RigStore::Loaded loaded = store_->loadRig();
  if (!loaded.note.empty()) log_.info(loaded.note);
  if (!loaded.problem.empty()) log_.warn(loaded.problem);
  loaded_rig_ = std::move(loaded.rig);
}

// Once the size of its images is known. The rig holds for the lenses that it was learnt with, so
// that it is restored with the last of them, or not at all.
void RigCalibrationNode::restoreCamera(int camera, int width, int height) {
  const std::string who = cameraText(options_, camera);
  const CalibrationStore::Loaded loaded =
      store_->loadCamera(camera, options_.camera.pipeline.model, width, height);
  for (const std::string& problem : loaded.problems) log_.warn(who + ": " + problem);
  if (loaded.state) {
    log_.info(who + ": what was learnt before is restored");
    calibrator_->restore(camera, loaded.state);
  }
  if (!loaded_rig_) return;
  const Camera& lens = loaded_rig_->rig.cameras[camera];
  if (!loaded.state || lens.width() != width || lens.height() != height) {
    log_.warn("the saved rig is not used, since " + who + " begins anew");
    loaded_rig_.reset();
  } else if (++cameras_restored_ == options_.cameras()) {
    calibrator_->restore(*loaded_rig_);
  }
}

void RigCalibrationNode::onImage(int camera, InputImage image) {
  Port& port = *ports_[camera];
  const std::string foreign = port.watch.check(image.publisher);
  if (!foreign.empty()) image.gray = {std::nullopt, foreign};
  if (image.gray.view) camera_info_->noteFrame(camera, image.header.frame_id);
  std::string problem = port.publisher->publish(image);
  const InputVerdict verdict = port.monitor.check(image.gray);
  if (verdict != InputVerdict::kUse) problem = port.monitor.counts().last_problem;
  if (!problem.empty()) log_.warnThrottled(cameraText(options_, camera) + ": " + problem);
  const std::string notice = port.monitor.takeNotice();
  const std::int64_t stamp_ns = toNanoseconds(image.header.stamp);
  if (!notice.empty()) {
    raise({EventType::kInput, stamp_ns, stamp_ns, notice}, cameraText(options_, camera));
  }
  const bool usable = verdict != InputVerdict::kReject;
  if (usable && !std::exchange(port.restored, true)) {
    restoreCamera(camera, image.gray.view->width, image.gray.view->height);
  }
  const bool dropped = usable && !calibrator_->process(camera, *image.gray.view);
  const std::lock_guard<std::mutex> lock(mutex_);
  port.counts = port.monitor.counts();
  port.frame = image.header.frame_id;
  port.last_image = ros::WallTime::now();
  port.dropped += dropped ? 1 : 0;
}

// From the threads of all cameras and that of the joint solutions.
void RigCalibrationNode::onReport(const RigReport& report) {
  const std::lock_guard<std::mutex> one_at_a_time(report_mutex_);
  if (closing_) return;
  for (const std::string& warning : camera_info_->update(report)) log_.warn(warning);
  const bool converged = report.state == CalibrationState::kConverged;
  if (converged && published_revision_ != report.revision) {
    publishPlaces(report);
    published_revision_ = report.revision;
  }
  if (const auto event = convergence_.next(report)) raise(*event, "the rig");
  if (tried_revision_ != report.revision) keep(report);
}

// Needs report_mutex_.
void RigCalibrationNode::keep(const RigReport& report) {
  const bool converged = report.state == CalibrationState::kConverged;
  if (!converged || !store_->hasFile() || saved_revision_ == report.revision) return;
  tried_revision_ = report.revision;
  if (saveTo(store_.get(), report).success) saved_revision_ = report.revision;
}

// What could not be saved, and is new still.
void RigCalibrationNode::saveAgain() {
  const std::lock_guard<std::mutex> one_at_a_time(report_mutex_);
  keep(calibrator_->report());
}

std::string RigCalibrationNode::frameOf(int camera) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  FrameNames names;
  names.image_frame = ports_[camera]->frame;
  if (!options_.camera_frames.empty()) names.child = options_.camera_frames[camera];
  return names.camera();
}

void RigCalibrationNode::publishPlaces(const RigReport& report) {
  const RigEstimate& estimate = report.estimate;
  std::vector<geometry_msgs::TransformStamped> transforms;
  const std::string rig_frame = frameOf(0);
  for (int c = 0; c < estimate.rig.size(); ++c) {
    const PlaceInRig& place = estimate.places[c];
    geometry_msgs::PoseWithCovarianceStamped message;
    message.header.stamp = toRosTime(estimate.poses.back().stamp_ns);
    message.header.frame_id = rig_frame;
    message.pose = toPoseWithCovariance(estimate.rig.rig_from_camera[c], place.position_covariance,
                                        place.rotation_covariance);
    ports_[c]->extrinsics.publish(message);
    if (c == 0 || frameOf(c) == rig_frame) continue;
    geometry_msgs::TransformStamped transform;
    transform.header = message.header;
    transform.child_frame_id = frameOf(c);
    transform.transform = toTransform(estimate.rig.rig_from_camera[c]);
    transforms.push_back(transform);
  }
  // REP 103: lengths in metres.
  if (transforms_ && estimate.metric && !transforms.empty()) {
    transforms_->sendTransform(transforms);
  }
}

void RigCalibrationNode::raise(const Event& event, const std::string& who) {
  Event told = event;
  told.sentence = who + ": " + event.sentence;
  log_.info(toString(event.type) + ": " + told.sentence);
  CalibrationEvent message = toCalibrationEvent(told, event.epoch);
  message.header.stamp = toRosTime(event.stamp_ns);
  message.header.frame_id = frameOf(0);
  event_.publish(message);
}

bool RigCalibrationNode::save(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  const CalibrationStore::Outcome outcome = saveTo(fallback_store_.get(), calibrator_->report());
  response.success = outcome.success;
  response.message = outcome.message;
  return true;
}

CalibrationStore::Outcome RigCalibrationNode::saveTo(RigStore* store, const RigReport& report) {
  std::vector<sensor_msgs::CameraInfo> infos;
  std::vector<std::shared_ptr<const LearntState>> states;
  for (int c = 0; c < options_.cameras(); ++c) {
    const Camera& camera = report.cameras[c].camera;
    infos.push_back(camera_info_->infoFor(c, std_msgs::Header(), camera.width(), camera.height()));
    states.push_back(calibrator_->state(c));
  }
  const CalibrationStore::Outcome outcome = store->save(report, infos, states);
  if (outcome.refused) return outcome;  // nothing is wrong with the files
  if (outcome.success) warnOfNotes(*store, report);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!outcome.success && outcome.message != saving_) log_.warn(outcome.message);
  saving_ = outcome.message;
  saving_failed_ = !outcome.success;
  return outcome;
}

// Once: each saving would say the same with other figures.
void RigCalibrationNode::warnOfNotes(const RigStore& store, const RigReport& report) {
  if (notes_told_) return;
  const std::vector<std::string> notes = store.notes(report);
  if (notes.empty() || notes_told_.exchange(true)) return;
  for (const std::string& note : notes) log_.warn(note);
}

// What an operator has to do something about; empty if nothing.
std::string RigCalibrationNode::inputProblem() {
  for (int c = 0; c < options_.cameras(); ++c) {
    Port& port = *ports_[c];
    const std::string who = cameraText(options_, c);
    if (port.last_image.isZero()) {
      return "Is " + who + " running, and is the name of its topic right?";
    }
    const double silence = (ros::WallTime::now() - port.last_image).toSec();
    if (silence > kSilence) return formatted("No image of %s for %.0f s.", who.c_str(), silence);
    if (port.counts.rejected > std::exchange(port.rejected_before, port.counts.rejected)) {
      return asSentence(who + ": " + port.counts.last_problem);
    }
    const std::int64_t dropped = port.dropped - std::exchange(port.dropped_before, port.dropped);
    if (dropped == 0) continue;
    return formatted(
        "Slower than the cameras: %lld images of %s were dropped since the last report. Lower the "
        "cameras' rate or resolution, or max_features.",
        static_cast<long long>(dropped), who.c_str());
  }
  return {};
}

void RigCalibrationNode::describe(diagnostic_updater::DiagnosticStatusWrapper& status) {
  if (!calibrator_) {
    status.summary(DiagnosticStatus::ERROR, idle_);
    return;
  }
  const RigReport report = calibrator_->report();
  const std::lock_guard<std::mutex> lock(mutex_);
  addVerdict(report, {inputProblem(), saving_failed_ ? saving_ : "", camera_info_->pairNote()},
             &status);
  status.add("state", toString(report.state));
  status.add("keyframes of the rig", report.keyframes);
  status.add("joint solutions", report.solutions);
  status.add("last joint solution [s]", report.solve_seconds);
  if (!report.last_failure.empty()) status.add("last joint solution", report.last_failure);
  if (!report.mount_changes.empty()) {
    status.add("last change of a mount", asSentence(report.mount_changes.back().sentence));
  }
  if (!saving_.empty()) status.add("saving", saving_);
  for (int c = 0; c < options_.cameras(); ++c) {
    const CalibrationReport& own = report.cameras[c];
    const std::string name = options_.camera_names[c];
    status.add(name + " topic", options_.image_topics[c]);
    status.add(name + " lens", toString(own.state) + ": " + own.sentence);
    status.add(name + " camera_info", camera_info_->stateText(c));
    status.add(name + " rate [Hz]", ports_[c]->counts.rate_hz);
    status.add(name + " images dropped", ports_[c]->dropped);
    status.add(name + " images rejected", ports_[c]->counts.rejected);
    if (report.estimate.usable && c > 0) {
      status.add(name + " place", placeText(report.estimate, c));
    }
  }
}

}  // namespace camera_self_calibration
