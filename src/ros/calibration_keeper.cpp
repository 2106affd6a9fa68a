#include "camera_self_calibration/ros/calibration_keeper.h"

#include <utility>

#include "camera_self_calibration/ros/calibration_url.h"
#include "camera_self_calibration/ros/driver_commit.h"
#include "camera_self_calibration/ros/file_parameters.h"

namespace camera_self_calibration {
namespace {

StoreOptions storeOptions(const NodeOptions& options, const std::string& camera_name) {
  StoreOptions store;
  store.camera_name = camera_name;
  if (!options.camera_info_url.empty()) {
    store.calibration_file = resolveCalibrationUrl(options.camera_info_url, camera_name).path;
  }
  store.state_file = resolvePath(options.state_file, camera_name).path;
  return store;
}

ControlOptions controlOptions(const NodeOptions& options, const std::string& camera_name,
                              const std::string& image_topic) {
  ControlOptions control;
  control.pipeline = options.pipeline;
  control.commit_service =
      options.commit_service.empty() ? driverService(image_topic) : options.commit_service;
  control.report_file = resolvePath(options.report_file, camera_name).path;
  control.autosave_interval_s = options.autosave_interval_s;
  control.initial_intrinsics = options.initial_intrinsics;
  return control;
}

}  // namespace

CalibrationKeeper::CalibrationKeeper(const ros::NodeHandle& private_node,
                                     const NodeOptions& options, const std::string& name,
                                     const std::string& image_topic, CalibrationSession* session,
                                     CameraInfoPolicy* camera_info, SizeMemory* sizes, Saved saved)
    : node_(private_node), model_(options.pipeline.model) {
  const std::string camera_name = cameraName(options, name);
  store_ = std::make_unique<CalibrationStore>(storeOptions(options, camera_name));
  StoreOptions fallback;
  fallback.camera_name = camera_name;
  fallback.calibration_file = resolveCalibrationUrl("", camera_name).path;
  fallback_store_ = std::make_unique<CalibrationStore>(fallback);

  ControlTargets targets;
  targets.with_calibrator = [session](const std::function<void(SelfCalibrator&)>& use) {
    return session->use(use);
  };
  targets.published_info = [session, camera_info] {
    Camera camera;
    session->use([&camera](SelfCalibrator& c) { camera = c.calibration().camera; });
    return camera_info->infoFor(std_msgs::Header(), camera.width(), camera.height());
  };
  targets.camera_info = camera_info;
  targets.sizes = sizes;
  targets.store = store_.get();
  targets.fallback_store = fallback_store_.get();
  targets.saved = std::move(saved);
  services_ = std::make_unique<ControlServices>(
      node_, controlOptions(options, camera_name, image_topic), targets);
}

const CalibrationStore::Loaded& CalibrationKeeper::load(int width, int height) {
  if (width == width_ && height == height_) return loaded_;
  width_ = width;
  height_ = height;
  loaded_ = store_->load(model_, width, height);
  for (const std::string& note : loaded_.notes) {
    ROS_INFO_STREAM(node_.getNamespace() << ": " << note);
  }
  for (const std::string& problem : loaded_.problems) {
    ROS_WARN_STREAM(node_.getNamespace() << ": " << problem);
  }
  return loaded_;
}

}  // namespace camera_self_calibration
