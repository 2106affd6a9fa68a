#include "camera_self_calibration/ros/calibration_keeper.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "camera_self_calibration/ros/calibration_url.h"
#include "camera_self_calibration/ros/driver_commit.h"

namespace camera_self_calibration {
namespace {

std::string cameraName(const NodeOptions& options, const std::string& node_name) {
  return options.camera_name.empty() ? toCameraName(node_name) : options.camera_name;
}

/// Whether two paths lead to one file, there or not, links followed.
bool areOneFile(const std::string& a, const std::string& b) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  const fs::path full_a = fs::weakly_canonical(a, error);
  const fs::path full_b = fs::weakly_canonical(b, error);
  return !error && full_a == full_b;
}

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
                                     CameraInfoPolicy* camera_info, Saved saved)
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

std::vector<std::string> keepingProblems(const NodeOptions& options) {
  std::vector<std::string> problems;
  const std::string name = options.camera_name.empty() ? "camera" : options.camera_name;
  if (!isCameraName(name)) {
    problems.push_back("camera_name is '" + name +
                       "'; it may hold letters, digits and underscores only");
  }
  const auto check = [&problems](const char* parameter, const ResolvedPath& resolved) {
    if (!resolved.error.empty()) problems.push_back(std::string(parameter) + ": " + resolved.error);
  };
  check("camera_info_url", resolveCalibrationUrl(options.camera_info_url, name));
  const std::string& url = options.camera_info_url;
  if (url.size() > 4 && url.compare(url.size() - 4, 4, ".ini") == 0) {
    problems.push_back("camera_info_url names an .ini file; only .yaml files are written");
  }
  check("state_file", resolvePath(options.state_file, name));
  check("report_file", resolvePath(options.report_file, name));
  if (options.report_file.empty()) problems.push_back("report_file must not be empty");
  if (!(options.autosave_interval_s >= 0.0)) {
    problems.push_back("autosave_interval_s must not be negative; 0 turns it off");
  }
  return problems;
}

std::vector<std::string> sameFileProblems(const NodeOptions& options, const std::string& name) {
  const std::string camera = cameraName(options, name);
  const std::string state = resolvePath(options.state_file, camera).path;
  const std::vector<std::pair<std::string, std::string>> files = {
      {"camera_info_url", resolveCalibrationUrl(options.camera_info_url, camera).path},
      {"state_file", state},
      {"state_file with .previous", state.empty() ? "" : state + ".previous"},
      {"report_file", resolvePath(options.report_file, camera).path},
      {"mask_url", resolvePath(options.mask_url, camera).path}};
  std::vector<std::string> problems;
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t j = i + 1; j < files.size(); ++j) {
      const auto& [a, path_a] = files[i];
      const auto& [b, path_b] = files[j];
      if (path_a.empty() || path_b.empty() || !areOneFile(path_a, path_b)) continue;
      problems.push_back(a + " and " + b + " are the same file, " + path_b +
                         "; each needs a file of its own");
    }
  }
  return problems;
}

}  // namespace camera_self_calibration
