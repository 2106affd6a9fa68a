#pragma once

#include <ros/node_handle.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/ros/calibration_session.h"
#include "camera_self_calibration/ros/calibration_store.h"
#include "camera_self_calibration/ros/camera_info_policy.h"
#include "camera_self_calibration/ros/control_services.h"
#include "camera_self_calibration/ros/node_options.h"
#include "camera_self_calibration/ros/size_memory.h"

namespace camera_self_calibration {

/// Everything about a calibration that outlives a run: files, services, saving by itself.
class CalibrationKeeper {
 public:
  using Saved = std::function<void(const CalibrationStore::Outcome&)>;

  /// `name` is the node's, `image_topic` the camera's; session, policy and sizes must outlive the
  /// keeper. `saved` hears how each saving ended.
  CalibrationKeeper(const ros::NodeHandle& private_node, const NodeOptions& options,
                    const std::string& name, const std::string& image_topic,
                    CalibrationSession* session, CameraInfoPolicy* camera_info, SizeMemory* sizes,
                    Saved saved);

  /// Whether what is learnt is saved by itself, since a file for it is named.
  bool keeps() const { return store_->hasFile(); }

  /// What the files say of a camera with images of this size. They are read, and it is logged what
  /// was taken and refused, when the size is another one than the last time.
  const CalibrationStore::Loaded& load(int width, int height);

  void setAutosaveInterval(double seconds) { services_->setAutosaveInterval(seconds); }

 private:
  ros::NodeHandle node_;
  const std::optional<CameraModel> model_;
  int width_ = 0;
  int height_ = 0;
  CalibrationStore::Loaded loaded_;
  std::unique_ptr<CalibrationStore> store_;
  std::unique_ptr<CalibrationStore> fallback_store_;
  std::unique_ptr<ControlServices> services_;
};

}  // namespace camera_self_calibration
