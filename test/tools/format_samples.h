#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "camera_self_calibration/tools/calibration_format.h"

namespace camera_self_calibration {

inline Camera camera(CameraModel model, const std::vector<double>& values) {
  return Camera(
      model, 752, 480,
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
}

// Numbers with many digits: all of them must survive.
inline const Camera kPinhole =
    camera(CameraModel::kPinhole, {458.654123456789, 457.3, 367.2 / 3, 1e2 / 7});
inline const Camera kFov = camera(CameraModel::kFov, {311.2, 309.8, 367.4, 233.1, 0.93 + 1e-15});
inline const Camera kRadtan =
    camera(CameraModel::kRadtan, {421.5, 421.6, 353.9, 251.8, -1.0 / 3, 0.166, -0.00066, -0.00131});
inline const Camera kRadtanK3 = camera(
    CameraModel::kRadtan, {421.5, 421.6, 353.9, 251.8, -0.33, 0.166, -0.00066, -0.00131, -0.0545});
inline const Camera kEquidistant =
    camera(CameraModel::kEquidistant, {300.5, 301.7, 367.2, 240.1, 0.01, -0.2 / 9, 1e-3, 1e-5});
inline const std::vector<Camera> kCameras = {kPinhole, kFov, kRadtan, kRadtanK3, kEquidistant};

inline const std::vector<CalibrationFormat> kFormats = {
    CalibrationFormat::kRos,    CalibrationFormat::kPlain,  CalibrationFormat::kKalibr,
    CalibrationFormat::kOpenCv, CalibrationFormat::kColmap, CalibrationFormat::kOrbSlam3,
    CalibrationFormat::kVins};

inline std::string failureOf(const std::string& text, CalibrationFormat format,
                             const std::string& wanted = {}) {
  try {
    parseCalibration(text, format, wanted);
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "no failure";
}

inline ::testing::AssertionResult says(const std::string& message, const std::string& words) {
  if (message.find(words) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "'" << message << "' does not say '" << words << "'";
}

inline std::string replaced(std::string text, const std::string& before, const std::string& after) {
  const std::size_t at = text.find(before);
  EXPECT_NE(at, std::string::npos) << before << " is not in\n" << text;
  return at == std::string::npos ? text : text.replace(at, before.size(), after);
}

constexpr const char* kCamchain = R"(cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.29, 0.08, 0.0002, 1.7e-05]
  distortion_model: radtan
  intrinsics: [461.6, 460.3, 363.0, 248.1]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.11]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: omni
  distortion_coeffs: [0.1, 0.1, 0.0, 0.0]
  distortion_model: radtan
  intrinsics: [1.3, 461.6, 460.3, 363.0, 248.1]
  resolution: [752, 480]
  rostopic: /cam1/image_raw
)";

}  // namespace camera_self_calibration
