#include "camera_self_calibration/ros/model_conversion.h"

#include <sensor_msgs/distortion_models.h>

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/camera/image_size.h"
#include "camera_self_calibration/camera/plausibility.h"
#include "camera_self_calibration/ros/camera_info.h"

namespace camera_self_calibration {
namespace {

/// 0 for a distortion model that is not known.
std::size_t coefficientCount(const std::string& distortion_model) {
  namespace names = sensor_msgs::distortion_models;
  if (distortion_model == names::PLUMB_BOB) return 5;
  if (distortion_model == names::RATIONAL_POLYNOMIAL) return 8;
  return distortion_model == names::EQUIDISTANT ? 4 : 0;
}

bool areNumbers(const sensor_msgs::CameraInfo& info) {
  const auto finite = [](double value) { return std::isfinite(value); };
  return std::all_of(info.K.begin(), info.K.end(), finite) &&
         std::all_of(info.D.begin(), info.D.end(), finite);
}

}  // namespace

std::optional<CameraFit> startFrom(const sensor_msgs::CameraInfo& info,
                                   std::optional<CameraModel> model) {
  const std::optional<CameraFit> read = toCamera(info, model);
  if (!read || !implausibility(read->camera).empty()) return std::nullopt;
  const Camera& camera = read->camera;
  if (!model || camera.model() == *model) return read;
  if (camera.model() == CameraModel::kPinhole && *model == CameraModel::kRadtan) {
    Intrinsics parameters = Intrinsics::Zero(Camera::parameterCount(*model));
    parameters.head<4>() = camera.parameters();
    return CameraFit{Camera(*model, camera.width(), camera.height(), parameters), {}};
  }
  const std::optional<CameraFit> fit = fitCamera(camera, *model);
  // A start that cannot project the whole image would later pass for a change of the lens.
  const bool usable = fit && std::isfinite(fit->error.max) && implausibility(fit->camera).empty();
  return usable ? fit : std::nullopt;
}

std::string whyNoCamera(const sensor_msgs::CameraInfo& info) {
  const std::size_t expected = coefficientCount(info.distortion_model);
  if (!areNumbers(info)) return "not all of its values are numbers";
  if (info.K[0] == 0.0) return "it is uncalibrated: its K is zero";
  if (info.width == 0 || info.height == 0) return "it has no image size";
  if (!isImageSize(info.width, info.height)) {
    return "no camera has images of " + std::to_string(info.width) + " x " +
           std::to_string(info.height);
  }
  if (!(info.K[0] > 0.0 && info.K[4] > 0.0)) return "its focal lengths are not positive";
  if (expected == 0) {
    return "its distortion_model '" + info.distortion_model +
           "' is not one of plumb_bob, rational_polynomial, equidistant";
  }
  if (!info.D.empty() && info.D.size() != expected) {
    return "its distortion_model " + info.distortion_model + " has " + std::to_string(expected) +
           " coefficients, but it holds " + std::to_string(info.D.size());
  }
  const std::string problem = implausibility(toCamera(info).value_or(undistorted(info)));
  return problem.empty() ? "" : "it cannot be right: " + problem;
}

std::string whyNoStart(const sensor_msgs::CameraInfo& info, std::optional<CameraModel> model) {
  const std::string problem = whyNoCamera(info);
  if (!problem.empty()) return problem;
  if (!model) return "its values describe no lens over the whole image";
  return "its values cannot be expressed in the model " + toString(*model) +
         " over the whole image; choose another ~model";
}

}  // namespace camera_self_calibration
