#include "camera_self_calibration/ros/self_calibration_node.h"

#include <image_transport/camera_common.h>

#include "camera_self_calibration/camera/plausibility.h"
#include "camera_self_calibration/ros/file_parameters.h"
#include "camera_self_calibration/ros/mask_file.h"
#include "camera_self_calibration/ros/stamps.h"

namespace camera_self_calibration {
namespace {

/// As image_transport::CameraSubscriber: beside the images, unless `camera_info` is remapped.
std::string cameraInfoTopic(const ros::NodeHandle& node) {
  const std::string remapped = node.resolveName("camera_info");
  if (remapped != node.resolveName("camera_info", false)) return remapped;
  return image_transport::getCameraInfoTopic(node.resolveName("image"));
}

/// What only the names of the graph show.
std::vector<std::string> namingProblems(const ros::NodeHandle& node,
                                        const ros::NodeHandle& private_node) {
  const std::string image = node.resolveName("image");
  if (image != private_node.resolveName("image_raw")) return {};
  return {"the images would come from this node itself, which publishes " + image +
          ": give the node another name, or remap `image` to the camera's topic"};
}

CameraInfoOptions cameraInfoOptions(const NodeOptions& options) {
  CameraInfoOptions result;
  result.min_change_px = options.min_publish_change_px;
  result.model =
      outputModelFromString(options.output_distortion_model).value_or(OutputModel::kAuto);
  result.publish_uncalibrated = options.publish_uncalibrated;
  result.fixed_projection = options.projection == "fixed";
  return result;
}

}  // namespace

SelfCalibrationNode::SelfCalibrationNode(const ros::NodeHandle& node,
                                         const ros::NodeHandle& private_node,
                                         const std::string& name)
    : node_(node), private_node_(private_node), log_(private_node.getNamespace()) {
  const NodeOptionsReading reading = readNodeOptions(private_node_);
  options_ = reading.options;
  camera_info_policy_ = std::make_unique<CameraInfoPolicy>(cameraInfoOptions(options_));
  diagnostics_ =
      std::make_unique<Diagnostics>(node_, private_node_, name, camera_info_policy_.get());
  input_ = std::make_unique<ImageInput>(node_, node_.resolveName("image"), options_.image_transport,
                                        [this](const InputImage& image) { onImage(image); });
  diagnostics_->setTopic(input_->topic());
  diagnostics_timer_ = private_node_.createWallTimer(
      ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { diagnostics_->publish(); });
  for (const std::string& warning : reading.warnings) log_.warn(warning);
  std::vector<std::string> problems = reading.problems;
  for (const std::string& problem : namingProblems(node_, private_node_)) {
    problems.push_back(problem);
  }
  for (const std::string& problem : sameFileProblems(options_, name)) problems.push_back(problem);
  const MaskReading mask = readMaskUrl(options_.mask_url);
  if (!mask.error.empty()) problems.push_back("mask_url: " + mask.error);
  options_.pipeline.tracker.mask = mask.mask;
  if (mask.mask) monitor_.setMask(*mask.mask);
  if (!problems.empty()) {
    stayIdle(problems);
    return;
  }
  if (options_.camera_info_input != "off") {
    factory_ =
        std::make_unique<FactoryCalibration>(cameraInfoTopic(node_), options_.factory_warn_px);
    diagnostics_->watch(factory_.get());
  }
  size_memory_ = std::make_unique<SizeMemory>(factory_.get());
  start_camera_ = std::make_unique<StartCamera>(&options_, factory_.get());
  results_ = std::make_unique<ResultPublisher>(private_node_, options_);
  camera_publisher_ = std::make_unique<CameraPublisher>(
      private_node_, [this](const std_msgs::Header& header, int width, int height) {
        return camera_info_policy_->infoFor(header, width, height);
      });
  visualizer_ = std::make_unique<Visualizer>(private_node_, options_);
  session_ = std::make_unique<CalibrationSession>(options_.pipeline, callbacks());
  if (factory_) factory_->subscribe(node_);
  keeper_ = std::make_unique<CalibrationKeeper>(
      private_node_, options_, name, input_->topic(), session_.get(), camera_info_policy_.get(),
      size_memory_.get(),
      [this](const CalibrationStore::Outcome& outcome) { diagnostics_->update(outcome); });
  diagnostics_->setKeeps(keeper_->keeps());
  live_parameters_ = std::make_unique<LiveParameters>(
      private_node_, [this](const SelfCalibrationConfig& config) { change(config); });
  input_->subscribe();
}

SelfCalibrationNode::~SelfCalibrationNode() {
  input_->shutdown();
  if (factory_) factory_->shutdown();
  diagnostics_timer_.stop();
  live_parameters_.reset();
  keeper_.reset();
  session_.reset();
}

void SelfCalibrationNode::stayIdle(const std::vector<std::string>& problems) {
  log_.idle(problems);
  diagnostics_->setProblems(problems);
  input_->shutdown();
}

void SelfCalibrationNode::onImage(const InputImage& image) {
  const std::string foreign = publisher_watch_.check(image.publisher);
  if (!foreign.empty()) {
    InputImage left_out = image;
    left_out.gray = {std::nullopt, foreign};
    check(left_out);
    return;
  }
  const std::string problem = camera_publisher_->publish(image);
  if (!problem.empty()) log_.warnThrottled(problem);
  const InputVerdict verdict = check(image);
  if (verdict == InputVerdict::kNewSize) {
    beginAnew(monitor_.counts().last_problem, image.header.stamp);
  } else if (verdict != InputVerdict::kReject &&
             size_memory_->windowMoved(monitor_.width(), monitor_.height())) {
    beginAnew("the images show another part of the sensor", image.header.stamp);
  }
  if (verdict == InputVerdict::kReject || !ready()) return;
  results_->setImageFrame(image.header.frame_id);
  diagnostics_->setFrameProblem(results_->frameProblem());
  visualizer_->add(*image.gray.view, image.header.frame_id);
  if (!session_->process(*image.gray.view)) ++dropped_images_;
}

InputVerdict SelfCalibrationNode::check(const InputImage& image) {
  const InputVerdict verdict = monitor_.check(image.gray);
  diagnostics_->update(monitor_.counts());
  if (verdict != InputVerdict::kUse) log_.warnThrottled(monitor_.counts().last_problem);
  const std::string notice = monitor_.takeNotice();
  const std::int64_t stamp_ns = toNanoseconds(image.header.stamp);
  if (!notice.empty()) raise({EventType::kInput, stamp_ns, stamp_ns, notice});
  return verdict;
}

bool SelfCalibrationNode::ready() {
  if (session_->running()) return true;
  // What the files hold comes first.
  const CalibrationStore::Loaded& kept = keeper_->load(monitor_.width(), monitor_.height());
  diagnostics_->setStorageProblems(kept.problems);
  StartDecision start;
  if (kept.camera) {
    start.camera = kept.camera;
  } else if (!kept.state) {
    start = start_camera_->decide(monitor_.width(), monitor_.height(), ros::WallTime::now());
  }
  if (start.wait) return false;
  if (start.warning) {
    log_.warn(start.sentence);
  } else if (!start.sentence.empty()) {
    log_.info(start.sentence);
  }
  if (!begin(start.camera)) return false;
  if (kept.state) session_->calibrator()->restore(kept.state);
  return true;
}

void SelfCalibrationNode::change(const SelfCalibrationConfig& config) {
  camera_info_policy_->setMinChange(config.min_publish_change_px);
  results_->setPublishTf(config.publish_tf);
  keeper_->setAutosaveInterval(config.autosave_interval_s);
}

bool SelfCalibrationNode::begin(const std::optional<Camera>& camera) {
  const std::string problem = session_->start(camera);
  if (!problem.empty()) stayIdle({problem});
  return problem.empty();
}

// The session ends here; unless something is known of the new images, ready() decides on its start.
void SelfCalibrationNode::beginAnew(const std::string& what, const ros::Time& stamp) {
  session_->stop();
  auto known = size_memory_->begin(monitor_.width(), monitor_.height());
  if (known && !implausibility(known->camera).empty()) known.reset();
  const std::int64_t stamp_ns = toNanoseconds(stamp);
  raise({EventType::kInput, stamp_ns, stamp_ns,
         what + (known ? "; the calibration is " + known->how + " and is checked"
                       : "; the calibration begins anew")});
  if (!known) return;
  camera_info_policy_->inherit(known->camera);
  begin(known->camera);
}

void SelfCalibrationNode::raise(const Event& event) {
  log_.info(toString(event.type) + ": " + event.sentence);
  visualizer_->add(event);
  diagnostics_->update(event);
  results_->publish(event);
}

Callbacks SelfCalibrationNode::callbacks() {
  Callbacks callbacks;
  callbacks.frame = [this](const FrameResult& result) {
    const std::int64_t dropped = dropped_images_;
    diagnostics_->update(result, dropped);
    visualizer_->add(result);
    results_->publish(result, dropped);
  };
  callbacks.calibration = [this](const CalibrationReport& report) {
    const std::string warning = camera_info_policy_->update(report);
    if (!warning.empty()) log_.warn(warning);
    diagnostics_->update(report);
    if (factory_) factory_->update(report);
    size_memory_->update(report);
    visualizer_->add(report);
    results_->publish(report);
  };
  callbacks.event = [this](const Event& event) {
    raise(withCameraInfo(event, camera_info_policy_->state()));
  };
  callbacks.map = [this](const MapView& view) {
    visualizer_->add(view.map_id, view.camera, view.newest);
  };
  return callbacks;
}

}  // namespace camera_self_calibration
