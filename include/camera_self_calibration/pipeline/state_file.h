#pragma once

#include <string>

#include "camera_self_calibration/pipeline/learnt_state.h"

namespace camera_self_calibration {

/// A state file, or in words why it cannot be used.
DecodedState readStateFile(const std::string& path);

}  // namespace camera_self_calibration
