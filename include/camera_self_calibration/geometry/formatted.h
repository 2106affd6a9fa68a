#pragma once

#include <string>

namespace camera_self_calibration {

/// The text that printf would print, whatever its length. The compiler checks the values against
/// the format.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

}  // namespace camera_self_calibration
