#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <optional>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

/// Which part of a sensor an image shows, and how coarsely: binning and region of interest of a
/// CameraInfo, in pixels of the full resolution.
struct SensorWindow {
  int full_width = 0;
  int full_height = 0;
  int x = 0;  ///< Of the region's first column.
  int y = 0;  ///< Of the region's first row.
  int width = 0;
  int height = 0;
  int binning_x = 1;
  int binning_y = 1;

  int imageWidth() const { return width / binning_x; }    ///< [px]
  int imageHeight() const { return height / binning_y; }  ///< [px]
  bool operator==(const SensorWindow& other) const;
  bool operator!=(const SensorWindow& other) const { return !(*this == other); }
};

/// A region of all zeros is the whole sensor, a binning of 0 is 1. Nothing where the region does
/// not lie on the sensor.
std::optional<SensorWindow> sensorWindow(const sensor_msgs::CameraInfo& info);

/// The camera of images of the window `to`, from that of images of the window `from`: binning b
/// takes a coordinate u of a pixel's centre to (u + 0.5) / b - 0.5, a crop subtracts its corner;
/// the distortion stays. Nothing where the windows are of different sensors or `camera` is not of
/// the size of `from`.
std::optional<Camera> throughWindow(const Camera& camera, const SensorWindow& from,
                                    const SensorWindow& to);

/// The camera that a CameraInfo describes (K, D and its width and height hold for the full
/// resolution), for images of its binning and region of interest. Nothing where
/// toCamera(info, model) gives nothing or the region is impossible.
std::optional<Camera> toWindowedCamera(const sensor_msgs::CameraInfo& info,
                                       std::optional<CameraModel> model);

}  // namespace camera_self_calibration
