#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>

#include <mutex>
#include <optional>
#include <string>

#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/ros/sensor_window.h"

namespace camera_self_calibration {

/// What the comparison with the factory calibration came to.
enum class FactoryVerdict {
  kNoMessage,     ///< No CameraInfo has come.
  kUncalibrated,  ///< Its K is zero.
  kUnusable,      ///< Another image size, an unknown distortion model, an impossible region.
  kWaiting,       ///< The live calibration is not CONVERGED yet.
  kAgrees,
  kDiffers
};

struct FactoryComparison {
  FactoryVerdict verdict = FactoryVerdict::kNoMessage;
  std::string sentence;  ///< The verdict in words, with what to do.
  PixelError distance;   ///< With kAgrees and kDiffers: live against factory, rotation-compensated.
};

/// Listens to the CameraInfo that the camera's driver publishes: a start for the calibration, a
/// yardstick for it, and what is known of binning and region of interest. Thread-safe.
class FactoryCalibration {
 public:
  /// `topic` is resolved. Differences above `warn_px` [px rms] that are significant too are worth a
  /// warning.
  FactoryCalibration(std::string topic, double warn_px);

  void subscribe(ros::NodeHandle node);
  void shutdown();
  /// For tests and subscribe().
  void take(const sensor_msgs::CameraInfo& info);

  const std::string& topic() const { return topic_; }
  bool heard() const;

  /// The factory's camera for images of this size, in the model to estimate; nothing with a reason
  /// in `problem` (never null).
  std::optional<Camera> startFor(std::optional<CameraModel> model, int width, int height,
                                 std::string* problem) const;

  /// What the newest message says of images of this size; nothing if it is about another size.
  std::optional<SensorWindow> windowFor(int width, int height) const;

  /// The newest live calibration.
  void update(const CalibrationReport& report);

  FactoryComparison comparison() const;

 private:
  std::optional<Camera> cameraFor(std::optional<CameraModel> model, int width, int height,
                                  FactoryComparison* result) const;
  void compare();

  const std::string topic_;
  const double warn_px_;
  ros::Subscriber subscriber_;

  mutable std::mutex mutex_;
  std::optional<sensor_msgs::CameraInfo> newest_;  // Without header.
  CalibrationReport report_;
  FactoryComparison comparison_;
};

}  // namespace camera_self_calibration
