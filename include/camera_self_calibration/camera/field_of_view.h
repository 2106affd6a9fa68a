#pragma once

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

/// Horizontal, vertical and diagonal field of view, through the principal point and between the
/// corners [deg]; not a number where the model has no ray for the border.
struct FieldOfView {
  double horizontal;
  double vertical;
  double diagonal;
};
FieldOfView fieldOfView(const Camera& camera);

}  // namespace camera_self_calibration
