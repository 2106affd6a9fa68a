#pragma once

#include <string>
#include <vector>

#include "camera_self_calibration/tools/recording.h"

namespace camera_self_calibration {

/// The clauses of the sentence of a state, which "; " separates, as sentences: the verdict first,
/// and then what the checks found.
std::vector<std::string> clauses(const std::string& sentence);

/// The outcome of a run for a terminal: state in words, a table of the parameters with sigma, and
/// the pixel uncertainty.
std::string reportText(const Recording& recording);

}  // namespace camera_self_calibration
