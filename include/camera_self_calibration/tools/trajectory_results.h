#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/reference/trajectory_comparison.h"
#include "camera_self_calibration/tools/recording.h"

namespace camera_self_calibration {

/// How good the trajectory of a run is.
struct TrajectoryResults {
  std::optional<std::int64_t> handover_ns;  ///< When the queue took over, if it did.
  /// From the run with the reference calibration held, before and after hand-over; lengths in that
  /// run's map units.
  std::optional<TrajectoryDifference> startup;
  std::optional<TrajectoryDifference> later;
  /// From the ground truth, in its unit: the whole run, what comes after hand-over, and the latter
  /// with the reference calibration held.
  std::optional<TrajectoryDifference> truth;
  std::optional<TrajectoryDifference> truth_later;
  std::optional<TrajectoryDifference> truth_reference;
};

/// `ground_truth` may be empty, as may the recording's poses with the reference calibration.
TrajectoryResults compareTrajectories(const Recording& recording,
                                      const std::vector<StampedCameraPose>& ground_truth);

/// Reads `t tx ty tz qx qy qz qw` (world_from_camera). Throws std::runtime_error that names file,
/// line and fault.
std::vector<StampedCameraPose> readGroundTruth(const std::string& path);

/// How far a trajectory is from the ground truth, one line for a terminal; empty if that is not
/// known.
std::string truthText(const char* what, const std::optional<TrajectoryDifference>& difference);

/// What trajectory texts begin with, as a line of its own.
constexpr const char* kTrajectoryHeading = "trajectory, after similarity alignment\n";

/// Sentences for a terminal, one a line; empty if nothing was compared.
std::string trajectoryText(const TrajectoryResults& results);

/// For summary.json.
Json trajectoryJson(const TrajectoryResults& results);

}  // namespace camera_self_calibration
