#pragma once

#include <string>

#include "camera_self_calibration/pipeline/results.h"

namespace camera_self_calibration {

/// Everything that a report says, as YAML with units in the names, for people and for bug reports.
std::string toYaml(const CalibrationReport& report, std::int64_t dropped_images);

/// Whether a text was made by toYaml().
bool isReportYaml(const std::string& text);

}  // namespace camera_self_calibration
