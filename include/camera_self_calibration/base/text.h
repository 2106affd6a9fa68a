#pragma once

#include <string>

namespace camera_self_calibration {

/// Whether bytes may be a text in UTF-8. yaml-cpp takes others for UTF-16 or UTF-32, and its
/// LoadAll() never ends where such a text is cut off within a letter.
inline bool isText(const std::string& bytes) {
  return bytes.find_first_of(std::string("\0\xFE\xFF", 3)) == std::string::npos;
}

}  // namespace camera_self_calibration
