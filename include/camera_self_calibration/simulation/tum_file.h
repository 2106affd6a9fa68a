#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/simulation/trajectory.h"

namespace camera_self_calibration {

/// Reads `t tx ty tz qx qy qz qw` (world_from_body) per line; empty lines and lines that begin with
/// '#' are skipped. Throws std::runtime_error that names file, line and fault.
std::vector<StampedPose> readTum(const std::string& path);

/// Writes the same format with nanosecond stamps. Throws std::runtime_error if it cannot.
void writeTum(const std::string& path, const std::vector<StampedPose>& poses);

struct RealMotionOptions {
  Eigen::Quaterniond body_from_camera = Eigen::Quaterniond::Identity();
  double start_s = 0.0;     ///< After the file's first pose: where the trajectory begins.
  double duration_s = 1e9;  ///< At most; the file's end may come first.
  /// If given, the positions are moved and, where they are too wide, scaled down about their
  /// middle, alike on all axes, to lie inside; heights keep their direction (z up).
  std::optional<Eigen::AlignedBox3d> fit_into;
};

/// A recorded trajectory as a camera's motion. Throws std::invalid_argument if less than two poses
/// are left, with the times that the recording has.
Trajectory realMotion(const std::vector<StampedPose>& recorded, const RealMotionOptions& options);

}  // namespace camera_self_calibration
