#pragma once

#include <string>

#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/tools/image_source.h"
#include "camera_self_calibration/tools/recording.h"

namespace camera_self_calibration {

/// Runs the inline pipeline over a sequence, with progress on a terminal. Images that
/// InputMonitor rejects are left out with a warning on standard error. Throws std::runtime_error if
/// images are there and none can be used, or the start values are for another image size, and
/// std::invalid_argument on bad options.
Recording calibrate(ImageSource* source, const Options& options);

}  // namespace camera_self_calibration
