#pragma once

#include <vector>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

inline Camera cameraOf(CameraModel model, int width, int height,
                       const std::vector<double>& parameters) {
  Intrinsics values(static_cast<int>(parameters.size()));
  for (int i = 0; i < values.size(); ++i) values[i] = parameters[static_cast<std::size_t>(i)];
  return Camera(model, width, height, values);
}

/// 70 degrees pinhole, 140 degrees fov, strong radtan, 170 degrees equidistant.
inline std::vector<Camera> testCameras() {
  return {cameraOf(CameraModel::kPinhole, 640, 480, {457.0, 456.0, 321.3, 238.1}),
          cameraOf(CameraModel::kFov, 640, 480, {250.0, 249.0, 317.4, 242.2, 0.95}),
          cameraOf(CameraModel::kRadtan, 640, 480,
                   {360.0, 361.0, 318.2, 237.9, -0.33, 0.166, -0.0006, -0.0012}),
          cameraOf(CameraModel::kEquidistant, 640, 480,
                   {215.0, 214.0, 320.7, 241.5, -0.01, 0.002, 0.0, 0.0})};
}

}  // namespace camera_self_calibration
