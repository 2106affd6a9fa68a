#pragma once

#include <ros/time.h>

#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/ros/factory_calibration.h"
#include "camera_self_calibration/ros/node_options.h"

namespace camera_self_calibration {

/// What a calibration starts from.
struct StartDecision {
  bool wait = false;             ///< Not decided yet: ask again with the next image.
  std::optional<Camera> camera;  ///< Of the model to estimate; nothing: the default guess.
  std::string sentence;          ///< For the log; empty if there is nothing to report.
  bool warning = false;          ///< Whether the sentence is one.
};

/// Decides what a calibration starts from: with `camera_info_input: initial` the factory's, for
/// which it waits a while, else the parameter initial_intrinsics, else the default guess.
class StartCamera {
 public:
  /// Wall time to wait for the first CameraInfo of the driver [s].
  static constexpr double kPatience = 3.0;

  /// `factory` may be null; both must outlive this object.
  StartCamera(const NodeOptions* options, const FactoryCalibration* factory)
      : options_(options), factory_(factory) {}

  /// For images of this size, at this wall time. initial_intrinsics hold for the first size asked
  /// for only.
  StartDecision decide(int width, int height, const ros::WallTime& now);

 private:
  StartDecision fromFactory(int width, int height, const ros::WallTime& now);
  StartDecision fromParameters(int width, int height) const;

  const NodeOptions* options_;
  const FactoryCalibration* factory_;
  ros::WallTime begin_;
  int first_width_ = 0;
  int first_height_ = 0;
};

/// The parameter initial_intrinsics, `values` of `model`, for images of this size; nothing, and
/// `problem` says so in sentences, where it cannot be right; nothing where it is not given.
std::optional<Camera> startFromParameters(CameraModel model, const std::vector<double>& values,
                                          int width, int height, std::string* problem);

}  // namespace camera_self_calibration
