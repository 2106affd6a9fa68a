#pragma once

#include <string>
#include <vector>

#include "camera_self_calibration/tools/fleet_results.h"

namespace camera_self_calibration {

/// The text of fleet.html: verdicts, values over time, outliers, what bags are worth. `problems`:
/// bags and files without a result, a sentence each. Bounded: charts of some dozens of cameras,
/// those that need a look first; the files hold the rest.
std::string fleetHtml(const std::vector<CameraResult>& cameras,
                      const std::vector<std::string>& problems);

}  // namespace camera_self_calibration
