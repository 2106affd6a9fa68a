#include "camera_self_calibration/ros/sensor_window.h"

#include <algorithm>
#include <cstdint>
#include <tuple>

#include "camera_self_calibration/ros/camera_info.h"

namespace camera_self_calibration {
namespace {

SensorWindow wholeSensor(const SensorWindow& window) {
  return {window.full_width, window.full_height, 0, 0, window.full_width, window.full_height, 1, 1};
}

}  // namespace

bool SensorWindow::operator==(const SensorWindow& other) const {
  const auto tie = [](const SensorWindow& w) {
    return std::tie(w.full_width, w.full_height, w.x, w.y, w.width, w.height, w.binning_x,
                    w.binning_y);
  };
  return tie(*this) == tie(other);
}

std::optional<SensorWindow> sensorWindow(const sensor_msgs::CameraInfo& info) {
  SensorWindow window;
  window.full_width = static_cast<int>(info.width);
  window.full_height = static_cast<int>(info.height);
  window.binning_x = std::max(1, static_cast<int>(info.binning_x));
  window.binning_y = std::max(1, static_cast<int>(info.binning_y));
  window.x = static_cast<int>(info.roi.x_offset);
  window.y = static_cast<int>(info.roi.y_offset);
  // By the message's definition a size of 0 means the whole resolution.
  window.width = info.roi.width == 0 ? window.full_width : static_cast<int>(info.roi.width);
  window.height = info.roi.height == 0 ? window.full_height : static_cast<int>(info.roi.height);
  const auto liesWithin = [](std::int64_t begin, std::int64_t size, std::int64_t full) {
    return begin >= 0 && begin + size <= full;
  };
  const bool possible = window.imageWidth() > 0 && window.imageHeight() > 0 &&
                        liesWithin(window.x, window.width, window.full_width) &&
                        liesWithin(window.y, window.height, window.full_height);
  return possible ? std::optional<SensorWindow>(window) : std::nullopt;
}

std::optional<Camera> throughWindow(const Camera& camera, const SensorWindow& from,
                                    const SensorWindow& to) {
  if (from.full_width != to.full_width || from.full_height != to.full_height ||
      camera.width() != from.imageWidth() || camera.height() != from.imageHeight()) {
    return std::nullopt;
  }
  const Eigen::Array2d binning_from(from.binning_x, from.binning_y);
  const Eigen::Array2d binning_to(to.binning_x, to.binning_y);
  const Eigen::Array2d corner_from(from.x, from.y);
  const Eigen::Array2d corner_to(to.x, to.y);
  Intrinsics p = camera.parameters();
  p.head<2>().array() *= binning_from / binning_to;
  // Counted from the corner of the sensor's first pixel, which lies half a pixel before its centre.
  const Eigen::Array2d centre = (p.segment<2>(2).array() + 0.5) * binning_from + corner_from;
  p.segment<2>(2) = (centre - corner_to) / binning_to - 0.5;
  Camera result(camera.model(), to.imageWidth(), to.imageHeight(), p);
  if (camera.estimatedCount() == kMaxIntrinsics) result.setEstimateK3(true);
  return result;
}

std::optional<Camera> toWindowedCamera(const sensor_msgs::CameraInfo& info,
                                       std::optional<CameraModel> model) {
  const std::optional<CameraFit> fit = toCamera(info, model);
  const std::optional<SensorWindow> window = sensorWindow(info);
  if (!fit || !window) return std::nullopt;
  return throughWindow(fit->camera, wholeSensor(*window), *window);
}

}  // namespace camera_self_calibration
