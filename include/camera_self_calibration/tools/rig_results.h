#pragma once

#include <string>
#include <vector>

#include "camera_self_calibration/reference/trajectory_comparison.h"
#include "camera_self_calibration/tools/calibrate_rig.h"

namespace camera_self_calibration {

/// The outcome for a terminal: the verdict in plain words, then what each camera found.
std::string rigText(const RigRecording& recording);

/// How far the trajectory is from the ground truth of the first camera, and its scale, in words;
/// empty where nothing could be compared.
std::string rigTrajectoryText(const std::optional<TrajectoryDifference>& difference, bool metric);

/// summary.json of a rig.
Json rigJson(const RigRecording& recording);

/// "CONVERGED", "CONVERGING", or "UNKNOWN" where nothing can be said of the rig.
std::string rigState(const RigRecording& recording);

/// Writes into an existing folder: what calibrate_bag writes for one camera into cam0/, cam1/, ...;
/// summary.json and trajectory.tum of the rig; and, if it has converged, camchain.yaml and, for two
/// cameras side by side, left.yaml and right.yaml. Removes those of an earlier run first. Returns
/// what is to be said of them, one sentence each. Throws std::runtime_error if a file cannot be
/// written.
std::vector<std::string> writeRig(const std::string& folder, const RigRecording& recording);

}  // namespace camera_self_calibration
