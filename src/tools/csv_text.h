#pragma once

#include <string>

namespace camera_self_calibration {

/// A cell of a CSV file that may hold anything.
inline std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? "\"\"" : std::string(1, c);
  return result + "\"";
}

}  // namespace camera_self_calibration
