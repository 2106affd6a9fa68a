#pragma once

#include <string>
#include <vector>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/rig/rig.h"
#include "camera_self_calibration/tools/calibration_format.h"

// What the readers and writers of the formats share.
namespace camera_self_calibration {

/// "1, 2, 3" of `count` values from `first` on.
std::string listText(const Intrinsics& values, Eigen::Index first, Eigen::Index count);

/// As YAML and OpenCV read a text: in quotation marks, unless it is a plain word, which may contain
/// some other characters too.
std::string wordText(const std::string& word, const std::string& also_plain = "");

/// "off by 0.1 px rms, 0.3 px at most".
std::string offBy(const PixelError& error);

/// The text without the line "%YAML:1.0" of cv::FileStorage, which is no YAML.
std::string withoutStorageHeader(const std::string& text);

/// A camera from values read; throws std::runtime_error on a wrong count, or where it cannot be one
/// of any lens (implausibility()).
Camera makeCamera(CameraModel model, int width, int height, const std::vector<double>& values);

/// Throws std::runtime_error: no model here has coefficients after k3.
[[noreturn]] void refuseRational();

/// radtan from k1 k2 p1 p2 and further coefficients of OpenCV's order (k3 k4 k5 k6 ...): without
/// those that are 0; pinhole if all are. Throws where coefficients after k3 are not 0.
Camera makeDistortedCamera(int width, int height, const std::vector<double>& focal_and_centre,
                           const std::vector<double>& coefficients);

/// The only entry, or the one wanted. Throws std::runtime_error that names those there are.
std::string chosenName(const std::vector<std::string>& names, const std::string& wanted);

StoredCalibration parseRos(const std::string& text);
StoredCalibration parsePlain(const std::string& text);
StoredCalibration parseKalibr(const std::string& text, const std::string& wanted);
StoredCalibration parseOpenCv(const std::string& text, const std::string& wanted);
StoredCalibration parseColmap(const std::string& text, const std::string& wanted);
StoredCalibration parseOrbSlam3(const std::string& text, const std::string& wanted);
StoredCalibration parseVins(const std::string& text);

/// All cameras of a camchain, with where they sit: throws where one has no T_cn_cnm1.
Rig parseKalibrRig(const std::string& text);

std::string rosText(const Camera& camera, const CalibrationLabels& labels);
std::string plainText(const Camera& camera);
/// One camera of a camchain, by its name there.
std::string kalibrText(const Camera& camera, const CalibrationLabels& labels,
                       const std::string& name = "cam0");
std::string openCvText(const Camera& camera);
std::string colmapText(const Camera& camera);
std::string orbSlam3Text(const Camera& camera, const CalibrationLabels& labels);
std::string vinsText(const Camera& camera, const CalibrationLabels& labels);

}  // namespace camera_self_calibration
