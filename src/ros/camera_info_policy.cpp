#include "camera_self_calibration/ros/camera_info_policy.h"

namespace camera_self_calibration {

void CameraInfoPolicy::update(const CalibrationReport& report) {
  const bool usable = report.state == CalibrationState::kConverged;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!usable) {
      camera_.reset();
      published_.reset();
      return;
    }
    if (camera_ && !(pixelDistance(*camera_, report.camera).rms > min_change_px_)) return;
  }
  // Unlocked, since images must not wait for the fit; only this thread changes what is published.
  const std::optional<CameraInfoConversion> conversion = toCameraInfo(report.camera);
  const std::lock_guard<std::mutex> lock(mutex_);
  camera_ = report.camera;
  published_ = conversion;
}

sensor_msgs::CameraInfo CameraInfoPolicy::infoFor(const std_msgs::Header& header, int width,
                                                  int height) const {
  sensor_msgs::CameraInfo info = uncalibratedCameraInfo(width, height);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (published_ && camera_->width() == width && camera_->height() == height) {
      info = published_->info;
    }
  }
  info.header = header;
  return info;
}

std::optional<PixelError> CameraInfoPolicy::conversionError() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return published_ ? std::optional<PixelError>(published_->error) : std::nullopt;
}

}  // namespace camera_self_calibration
