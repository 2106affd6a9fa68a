#pragma once

#include "camera_self_calibration/tools/image_source.h"

namespace camera_self_calibration {

/// As openBag, but in this process, which a damaged bag may crash.
ImageSource openBagHere(const SourceOptions& options);

}  // namespace camera_self_calibration
