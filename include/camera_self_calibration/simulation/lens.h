#pragma once

#include <functional>
#include <optional>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

/// A camera whose focal length may change once, within one frame.
struct Lens {
  Camera camera;                    ///< Before the zoom.
  std::optional<double> zoom_at_s;  ///< When, on the trajectory's clock [s]; none: never.
  double zoom = 1.0;                ///< fx and fy are multiplied by it.
  /// If given, the camera at a time [s], in place of the above; for feature tracks only.
  std::function<Camera(double)> over_time = nullptr;

  bool zoomed(double time_s) const { return zoom_at_s && time_s >= *zoom_at_s; }

  /// The true camera at a time [s].
  Camera at(double time_s) const {
    if (over_time) return over_time(time_s);
    Camera now = camera;
    if (!zoomed(time_s)) return now;
    Intrinsics parameters = now.parameters();
    parameters.head<2>() *= zoom;
    now.setParameters(parameters);
    return now;
  }
};

}  // namespace camera_self_calibration
