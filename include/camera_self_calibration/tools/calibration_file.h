#pragma once

#include <string>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

/// Reads a calibration: a ROS YAML file (camera_matrix, distortion_model, ...) or one with the keys
/// model, width, height, params (in the order of CameraModel). Throws std::runtime_error that says
/// what is wrong.
Camera readCalibrationFile(const std::string& path);

/// Writes the YAML of camera_calibration_parsers, which camera_info_manager reads; a model without
/// a standard name is converted. Throws std::runtime_error if that or the writing fails.
void writeRosCalibration(const std::string& path, const std::string& camera_name,
                         const Camera& camera);

/// Writes Kalibr's camchain with one camera. Throws std::runtime_error if it cannot be written.
void writeKalibrCalibration(const std::string& path, const std::string& topic,
                            const Camera& camera);

}  // namespace camera_self_calibration
