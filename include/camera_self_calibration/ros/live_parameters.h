#pragma once

#include <camera_self_calibration/SelfCalibrationConfig.h>
#include <dynamic_reconfigure/server.h>

#include <functional>

namespace camera_self_calibration {

/// The few parameters that may change while the node runs, through dynamic_reconfigure
/// (cfg/SelfCalibration.cfg). They start with the node's parameters.
class LiveParameters {
 public:
  using Callback = std::function<void(const SelfCalibrationConfig&)>;

  /// `changed` is called at once, and with each change.
  LiveParameters(const ros::NodeHandle& private_node, const Callback& changed)
      : server_(private_node) {
    server_.setCallback(
        [changed](SelfCalibrationConfig& config, std::uint32_t) { changed(config); });
  }

 private:
  dynamic_reconfigure::Server<SelfCalibrationConfig> server_;
};

}  // namespace camera_self_calibration
