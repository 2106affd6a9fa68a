#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <yaml-cpp/yaml.h>

#include <string>

namespace camera_self_calibration {

/// A calibration as camera_info_manager keeps it.
struct NamedCameraInfo {
  std::string name;  ///< Made up where the text has none.
  sensor_msgs::CameraInfo info;
};

/// From the YAML of camera_info_manager. Throws std::runtime_error, with the reason, on all that it
/// cannot read, and on that which would end the process there.
NamedCameraInfo parseCalibrationYaml(const std::string& text);

/// The value under a key of a map. Throws std::runtime_error where it is missing.
YAML::Node neededValue(const YAML::Node& yaml, const char* key);

}  // namespace camera_self_calibration
