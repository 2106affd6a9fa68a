#pragma once

#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

inline Intrinsics intrinsics(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), values.size());
}

inline Camera camera640(CameraModel model, const std::vector<double>& values) {
  return Camera(model, 640, 480, intrinsics(values));
}

/// Cameras of every model, from no distortion to strong distortion.
inline std::vector<Camera> sampleCameras() {
  return {
      camera640(CameraModel::kPinhole, {320, 320, 319.5, 239.5}),
      camera640(CameraModel::kPinhole, {615, 580, 300, 260}),
      camera640(CameraModel::kFov, {320, 320, 319.5, 239.5, 1.0}),
      camera640(CameraModel::kFov, {280, 270, 300, 250, 0.93}),
      camera640(CameraModel::kFov, {402, 400, 340, 277, 1.13}),
      camera640(CameraModel::kFov, {600, 600, 319.5, 239.5, 0.05}),
      camera640(CameraModel::kFov, {600, 600, 319.5, 239.5, 1e-5}),
      camera640(CameraModel::kFov, {250, 255, 319.5, 239.5, 1.5}),
      camera640(CameraModel::kFov, {500, 500, 319.5, 239.5, 2.9}),
      camera640(CameraModel::kRadtan, {320, 320, 319.5, 239.5, 0, 0, 0, 0}),
      camera640(CameraModel::kRadtan, {458.7, 457.3, 367.2, 248.4, -0.283, 0.0739, 2e-4, 1.8e-5}),
      Camera(CameraModel::kRadtan, 752, 480,
             intrinsics({421.52, 421.55, 353.95, 251.81, -0.33039, 0.16623, -0.00066, -0.00131,
                         -0.05446})),
      camera640(CameraModel::kRadtan, {420, 425, 310, 250, 0.2, -0.4, 0.01, -0.008}),
      camera640(CameraModel::kEquidistant, {320, 320, 319.5, 239.5, 0, 0, 0, 0}),
      camera640(CameraModel::kEquidistant,
                {190.98, 190.97, 254.93, 256.9, 0.00348, 0.000715, -0.00205, 0.000202}),
      camera640(CameraModel::kEquidistant, {300, 290, 330, 230, -0.12, 0.05, -0.03, 0.004}),
  };
}

inline std::string describe(const Camera& camera) {
  std::string text = toString(camera.model());
  for (Eigen::Index i = 0; i < camera.parameters().size(); ++i) {
    text += " " + std::to_string(camera.parameters()(i));
  }
  return text;
}

}  // namespace camera_self_calibration
