#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <optional>
#include <string>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {

/// The standard distortion models; any other name stops image_geometry and with it image_proc.
enum class OutputModel {
  kAuto,  ///< pinhole and radtan as plumb_bob, equidistant and fov as equidistant.
  kPlumbBob,
  kRationalPolynomial,
  kEquidistant
};

/// "auto", "plumb_bob", "rational_polynomial", "equidistant"; nothing for any other string.
std::optional<OutputModel> outputModelFromString(const std::string& name);

/// Intrinsics as consumers of ROS read them.
struct CameraInfoConversion {
  sensor_msgs::CameraInfo info;  ///< Without header; R is the identity, P is [K | 0].
  /// What the conversion costs [px]; 0 where it is exact, infinite where the distortion model
  /// cannot project all of the image.
  PixelError error;
};

/// In the distortion model asked for: exact where it holds the camera's own, else the one that fits
/// best. Nothing where the fit is not possible or `camera` is not valid.
std::optional<CameraInfoConversion> toCameraInfo(const Camera& camera,
                                                 OutputModel output = OutputModel::kAuto);

/// All zeros but the size: "not calibrated" by the convention K[0] == 0.
sensor_msgs::CameraInfo uncalibratedCameraInfo(int width, int height);

/// By the same convention.
inline bool isCalibrated(const sensor_msgs::CameraInfo& info) { return info.K[0] > 0.0; }

/// Why a CameraInfo that is not calibrated is neither saved nor given on.
constexpr const char* kUncalibrated = "camera_info is zeros (/diagnostics says why)";

/// The camera that a CameraInfo describes: "plumb_bob" gives radtan (k3 only if not 0; pinhole if
/// all coefficients are 0), "equidistant" equidistant. Nothing for other names, wrong lengths or an
/// uncalibrated message. "rational_polynomial" gives radtan if it is one (k4 = k5 = k6 = 0).
std::optional<Camera> toCamera(const sensor_msgs::CameraInfo& info);

/// The same with error 0, and for a "rational_polynomial" that is no radtan the camera of `model`
/// that fits it over the whole image; of equidistant where none is given. Nothing where the message
/// cannot be right (implausibility() of undistorted()) or no fit reaches the whole image.
std::optional<CameraFit> toCamera(const sensor_msgs::CameraInfo& info,
                                  std::optional<CameraModel> model);

/// The pinhole camera of K: what is implausible about it is so whatever the distortion.
Camera undistorted(const sensor_msgs::CameraInfo& info);

/// Whether R and P are those of one camera of a stereo pair: more than a camera knows of itself.
bool isOfAPair(const sensor_msgs::CameraInfo& info);

}  // namespace camera_self_calibration
