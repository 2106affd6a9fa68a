#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <optional>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {

/// Intrinsics as consumers of ROS read them.
struct CameraInfoConversion {
  sensor_msgs::CameraInfo info;  ///< Without header; R is the identity, P is [K | 0].
  PixelError error;              ///< What the conversion costs [px]; 0 where it is exact.
};

/// Standard names only, since others stop image_geometry: pinhole and radtan go out as "plumb_bob"
/// (exact), equidistant as "equidistant" (exact), fov as the fitted "equidistant". Nothing where
/// the fit is not possible or `camera` is not valid.
std::optional<CameraInfoConversion> toCameraInfo(const Camera& camera);

/// All zeros but the size: "not calibrated" by the convention K[0] == 0.
sensor_msgs::CameraInfo uncalibratedCameraInfo(int width, int height);

/// The camera that a CameraInfo describes: "plumb_bob" gives radtan (k3 only if not 0; pinhole if
/// all coefficients are 0), "equidistant" equidistant. Nothing for other names, wrong lengths or an
/// uncalibrated message.
std::optional<Camera> toCamera(const sensor_msgs::CameraInfo& info);

}  // namespace camera_self_calibration
