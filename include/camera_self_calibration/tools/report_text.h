#pragma once

#include <string>

#include "camera_self_calibration/tools/recording.h"

namespace camera_self_calibration {

/// The outcome of a run for a terminal: state in words, a table of the parameters with sigma, and
/// the pixel uncertainty.
std::string reportText(const Recording& recording);

}  // namespace camera_self_calibration
