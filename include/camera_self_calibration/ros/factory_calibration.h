#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>

#include <mutex>
#include <optional>
#include <string>

#include "camera_self_calibration/audit/audit_history.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/ros/sensor_window.h"

namespace camera_self_calibration {

/// What the driver's calibration is worth.
struct FactoryAudit {
  bool usable = false;   ///< One that can be read has come.
  AuditReport audit;     ///< What the live calibration says of it, if so.
  std::string sentence;  ///< For people, with what to do.
};

/// Listens to the CameraInfo that the camera's driver publishes: a start for the calibration, what
/// is audited by it, and what is known of binning and region of interest. Thread-safe.
class FactoryCalibration {
 public:
  /// `topic` is resolved. `tolerance_px` as in AuditOptions.
  FactoryCalibration(std::string topic, double tolerance_px);

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

  FactoryAudit audit() const;

 private:
  std::optional<Camera> read(std::optional<CameraModel> model, std::string* problem) const;
  void judge();

  const std::string topic_;
  const AuditOptions options_;
  ros::Subscriber subscriber_;

  mutable std::mutex mutex_;
  std::optional<sensor_msgs::CameraInfo> newest_;  // Without header.
  CalibrationReport report_;
  AuditHistory history_;  // of newest_
  FactoryAudit audit_;
};

}  // namespace camera_self_calibration
