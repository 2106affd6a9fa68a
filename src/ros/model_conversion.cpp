#include "camera_self_calibration/ros/model_conversion.h"

#include <cmath>

#include "camera_self_calibration/ros/camera_info.h"

namespace camera_self_calibration {

std::optional<CameraFit> startFrom(const sensor_msgs::CameraInfo& info, CameraModel model) {
  const std::optional<Camera> camera = toCamera(info, model);
  if (!camera || camera->width() <= 0 || camera->height() <= 0) return std::nullopt;
  if (camera->model() == model) return CameraFit{*camera, {}};
  if (camera->model() == CameraModel::kPinhole && model == CameraModel::kRadtan) {
    Intrinsics parameters = Intrinsics::Zero(Camera::parameterCount(model));
    parameters.head<4>() = camera->parameters();
    return CameraFit{Camera(model, camera->width(), camera->height(), parameters), {}};
  }
  const std::optional<CameraFit> fit = fitCamera(*camera, model);
  // A start that cannot project the whole image would later pass for a change of the lens.
  return fit && std::isfinite(fit->error.max) ? fit : std::nullopt;
}

}  // namespace camera_self_calibration
