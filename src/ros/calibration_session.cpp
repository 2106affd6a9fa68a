#include "camera_self_calibration/ros/calibration_session.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace camera_self_calibration {

CalibrationSession::CalibrationSession(const Options& options, Callbacks callbacks)
    : options_(options), callbacks_(std::move(callbacks)) {}

std::string CalibrationSession::start(const std::optional<Camera>& initial_camera) {
  stop();
  if (started_) {
    base_ = {newest_.map_id + 1, newest_.revision + 1, newest_.epoch + 1, newest_.starts_given_up};
  }
  started_ = true;
  try {
    Options options = options_;
    options.initial_camera = initial_camera;
    auto calibrator =
        std::make_unique<SelfCalibrator>(options, SelfCalibrator::Mode::kThreaded, continued());
    const std::lock_guard<std::mutex> lock(calibrator_mutex_);
    calibrator_ = std::move(calibrator);
    return {};
  } catch (const std::exception& e) {
    return e.what();
  }
}

void CalibrationSession::stop() {
  std::unique_ptr<SelfCalibrator> ended;
  const std::lock_guard<std::mutex> lock(calibrator_mutex_);
  ended.swap(calibrator_);
}

bool CalibrationSession::use(const std::function<void(SelfCalibrator&)>& use) const {
  const std::lock_guard<std::mutex> lock(calibrator_mutex_);
  if (calibrator_) use(*calibrator_);
  return calibrator_ != nullptr;
}

Callbacks CalibrationSession::continued() const {
  Callbacks result;
  result.frame = [this](const FrameResult& frame) { pass(frame); };
  result.calibration = [this](const CalibrationReport& report) { pass(report); };
  result.event = callbacks_.event;
  result.map = [this](const MapView& view) {
    if (callbacks_.map) callbacks_.map({view.map_id + base_.map_id, view.camera, view.newest});
  };
  return result;
}

void CalibrationSession::pass(FrameResult result) const {
  result.map_id += base_.map_id;
  if (result.moved) {
    result.moved->from += base_.map_id;
    result.moved->to += base_.map_id;
  }
  result.calibration_revision += base_.revision;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    newest_.map_id = std::max(newest_.map_id, result.map_id);
  }
  if (callbacks_.frame) callbacks_.frame(result);
}

void CalibrationSession::pass(CalibrationReport report) const {
  report.revision += base_.revision;
  report.epoch += base_.epoch;
  report.starts_given_up += base_.starts_given_up;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    newest_.revision = std::max(newest_.revision, report.revision);
    newest_.epoch = std::max(newest_.epoch, report.epoch);
    newest_.starts_given_up = std::max(newest_.starts_given_up, report.starts_given_up);
  }
  if (callbacks_.calibration) callbacks_.calibration(report);
}

}  // namespace camera_self_calibration
