#pragma once

#include <string>

#include "camera_self_calibration/tools/recording.h"
#include "camera_self_calibration/tools/trajectory_results.h"

namespace camera_self_calibration {

/// What a report says of the run itself.
struct RunDescription {
  std::string input;                 ///< Bag, folder or video, as it was given.
  std::string topic;                 ///< Of a bag; else the folder or file.
  std::string options;               ///< Those that bear on the result; empty: the defaults.
  double converged_pixel_rms = 0.0;  ///< CONVERGED below this [px].
  std::string date;                  ///< Of the run, in words.
};

/// The name of a bag, folder or video, without where it is.
std::string inputName(const std::string& path);

/// The text of report.html: a run as a page to send to a colleague, with all pictures in it. What
/// was not computed (batch, reference calibration, ground truth) has no section. Runs with the same
/// input and options have the same page, but for the line that begins with <p id="run">: date and
/// duration of the run.
std::string reportHtml(const RunDescription& run, const Recording& recording,
                       const TrajectoryResults& trajectory,
                       const std::vector<StampedCameraPose>& ground_truth);

}  // namespace camera_self_calibration
