#pragma once

#include <map>
#include <optional>
#include <string>

namespace camera_self_calibration {

using ArgumentValues = std::map<std::string, std::string>;  ///< By name, such as "--seconds".

/// `values` with those of the command line's pairs "--name value" in place of its own; nothing
/// where one has no value or a name that `values` does not know: prints what is known then.
std::optional<ArgumentValues> readArguments(int argc, char** argv, ArgumentValues values);

}  // namespace camera_self_calibration
