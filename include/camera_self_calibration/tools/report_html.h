#pragma once

#include <string>

#include "camera_self_calibration/tools/recording.h"
#include "camera_self_calibration/tools/trajectory_results.h"

namespace camera_self_calibration {

/// The text of report.html: a run as a page to send to a colleague, with all pictures in it. What
/// was not computed (batch, reference calibration, ground truth) has no section.
std::string reportHtml(const std::string& source_name, const Recording& recording,
                       const TrajectoryResults& trajectory,
                       const std::vector<StampedCameraPose>& ground_truth);

}  // namespace camera_self_calibration
