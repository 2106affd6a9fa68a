#include "camera_self_calibration/ros/size_memory.h"

namespace camera_self_calibration {
namespace {

// Images and their CameraInfo come on two topics and may overtake each other.
constexpr int kMovePatience = 5;

}  // namespace

void SizeMemory::update(const CalibrationReport& report) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (epoch_ && *epoch_ != report.epoch) learnt_.clear();
  epoch_ = report.epoch;
  const bool converged = report.state == CalibrationState::kConverged;
  awaits_beginning_ = awaits_beginning_ && converged;
  if (!converged || awaits_beginning_) return;
  newest_ = {report.camera.width(), report.camera.height()};
  learnt_[newest_] = {report.camera, window_};
}

void SizeMemory::forget() {
  const std::lock_guard<std::mutex> lock(mutex_);
  learnt_.clear();
  awaits_beginning_ = true;
}

bool SizeMemory::windowMoved(int width, int height) {
  if (factory_ == nullptr) return false;
  const std::optional<SensorWindow> now = factory_->windowFor(width, height);
  if (!now) return false;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!window_) window_ = now;
  moved_images_ = *window_ == *now ? 0 : moved_images_ + 1;
  return moved_images_ >= kMovePatience;
}

std::optional<SizeMemory::Known> SizeMemory::begin(int width, int height) {
  const std::optional<SensorWindow> window =
      factory_ == nullptr ? std::nullopt : factory_->windowFor(width, height);
  const std::lock_guard<std::mutex> lock(mutex_);
  window_ = window;
  epoch_.reset();
  moved_images_ = 0;
  awaits_beginning_ = false;
  std::optional<Known> known = rescaled();
  return known ? known : seenBefore({width, height});
}

std::optional<SizeMemory::Known> SizeMemory::rescaled() const {
  const auto found = learnt_.find(newest_);
  if (found == learnt_.end() || !found->second.window || !window_) return std::nullopt;
  const std::optional<Camera> camera =
      throughWindow(found->second.camera, *found->second.window, *window_);
  if (!camera) return std::nullopt;
  return Known{*camera, "rescaled by the driver's binning and region of interest"};
}

std::optional<SizeMemory::Known> SizeMemory::seenBefore(const Size& size) const {
  const auto found = learnt_.find(size);
  if (found == learnt_.end()) return std::nullopt;
  // Another part of the sensor, of the same size, has another principal point.
  const auto& window = found->second.window;
  if (window && window_ && *window != *window_) return std::nullopt;
  return Known{found->second.camera, "the one learnt at this size before"};
}

}  // namespace camera_self_calibration
