#pragma once

#include <diagnostic_updater/diagnostic_updater.h>

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/ros/camera_info_policy.h"
#include "camera_self_calibration/ros/factory_calibration.h"
#include "camera_self_calibration/ros/input_monitor.h"
#include "camera_self_calibration/ros/storage_status.h"

namespace camera_self_calibration {

/// Tells an operator on /diagnostics in plain sentences how the node fares: tracking, calibration,
/// queue, timing with drops. Thread-safe.
class Diagnostics {
 public:
  Diagnostics(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
              const std::string& name, const CameraInfoPolicy* camera_info);

  /// The node cannot work, for these reasons.
  void setProblems(const std::vector<std::string>& problems);
  /// What of the saved files could not be used.
  void setStorageProblems(const std::vector<std::string>& problems);
  /// Whether what is learnt is saved at all.
  void setKeeps(bool keeps);
  /// How the newest saving ended.
  void update(const CalibrationStore::Outcome& saving);
  void setTopic(const std::string& topic);
  /// Why no transform goes out; empty if nothing hinders it.
  void setFrameProblem(const std::string& problem);
  /// Adds what the comparison with the factory calibration comes to; it must outlive this object.
  void watch(const FactoryCalibration* factory);
  void update(const FrameResult& result, std::int64_t dropped_images);
  void update(const CalibrationReport& report);
  void update(const InputCounts& input);
  /// Told with the tracking, or with the calibration if it is of that.
  void update(const Event& event);

  /// Publishes; called about once a second.
  void publish();

 private:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;
  /// Since the last publication.
  struct Interval {
    std::int64_t frames = 0;
    double seconds_sum = 0.0;
    double seconds_max = 0.0;
    std::int64_t dropped_before = 0;
    InputCounts before;
  };

  void tracking(Status& status);
  void calibration(Status& status);
  void queue(Status& status);
  void timing(Status& status);
  void factory(Status& status);
  void storage(Status& status);
  bool addProblems(Status* status) const;
  double silence() const;

  diagnostic_updater::Updater updater_;
  const CameraInfoPolicy* camera_info_;
  const FactoryCalibration* factory_ = nullptr;
  mutable std::mutex mutex_;
  std::string idle_;  // why, in a sentence; empty if the node works
  std::string topic_;
  StorageStatus storage_;
  std::string frame_problem_;
  FrameResult frame_;
  CalibrationReport report_;
  InputCounts input_;
  std::optional<Event> tracking_event_;     // the newest of them
  std::optional<Event> calibration_event_;  // likewise
  std::int64_t losses_ = 0;
  std::int64_t carried_ = 0;  // features, see CarriedFeatures
  std::int64_t dropped_ = 0;
  ros::WallTime last_image_;  // When the input was heard last; zero before.
  Interval interval_;
  ros::WallTime interval_begin_ = ros::WallTime::now();
};

}  // namespace camera_self_calibration
