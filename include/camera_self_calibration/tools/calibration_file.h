#pragma once

#include <optional>
#include <string>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/rig/rig.h"
#include "camera_self_calibration/tools/calibration_format.h"

namespace camera_self_calibration {

/// Reads a calibration in any of the formats, which is detected from the contents. Throws
/// std::runtime_error that says what is wrong.
Camera readCalibrationFile(const std::string& path);

struct CalibrationInFile {
  StoredCalibration stored;
  CalibrationFormat format = CalibrationFormat::kRos;
};

/// The same, with what is known of the file: `format`, if given, and `wanted` as in
/// parseCalibration().
CalibrationInFile readCalibration(const std::string& path, std::optional<CalibrationFormat> format,
                                  const std::string& wanted);

/// The cameras of a rig and where they sit, from Kalibr's camchain. Throws as readCalibration().
Rig readRigCalibration(const std::string& path);

/// Writes a calibration, fitted where the format does not have the model; what that costs is
/// returned and noted in the file. The text is read back and compared first, and an existing file
/// is replaced at one stroke. Throws std::runtime_error if it cannot be written or fitted.
CameraFit writeCalibration(const std::string& path, const Camera& camera, CalibrationFormat format,
                           const CalibrationLabels& labels = {});

}  // namespace camera_self_calibration
