#pragma once

#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/reference/trajectory_comparison.h"
#include "camera_self_calibration/tools/calibrate_rig.h"
#include "camera_self_calibration/tools/report_html.h"

namespace camera_self_calibration {

/// The text of a rig's report.html: what joins the cameras. Each camera has a page of its own
/// (reportHtml), which this one links to, in cameraFolder(). `truth`: how far the trajectory is
/// from `ground_truth`, if that was given. `run.topic` and the limit of a camera do not matter.
std::string rigReportHtml(const RunDescription& run, const RigRecording& recording,
                          const std::optional<TrajectoryDifference>& truth,
                          const std::vector<StampedCameraPose>& ground_truth);

}  // namespace camera_self_calibration
