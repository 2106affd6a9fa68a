#pragma once

#include <std_msgs/Header.h>

#include <mutex>
#include <optional>

#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/ros/camera_info.h"

namespace camera_self_calibration {

/// Decides which CameraInfo goes out: zeros until CONVERGED, and a new estimate only if it differs
/// visibly, since every change makes consumers rebuild their rectification maps. Thread-safe.
class CameraInfoPolicy {
 public:
  /// `min_change_px`: rms distance to the published calibration [px].
  explicit CameraInfoPolicy(double min_change_px) : min_change_px_(min_change_px) {}

  void update(const CalibrationReport& report);

  /// For an image of this header and size.
  sensor_msgs::CameraInfo infoFor(const std_msgs::Header& header, int width, int height) const;

  /// What the published message deviates from the estimated model [px]; nothing while zeros go out.
  std::optional<PixelError> conversionError() const;

 private:
  const double min_change_px_;
  mutable std::mutex mutex_;
  std::optional<Camera> camera_;  // Behind published_.
  std::optional<CameraInfoConversion> published_;
};

}  // namespace camera_self_calibration
