#pragma once

#include <algorithm>
#include <string>

namespace camera_self_calibration {

/// Whether bytes may be a text in UTF-8. yaml-cpp takes others for UTF-16 or UTF-32, and its
/// LoadAll() never ends where such a text is cut off within a letter.
inline bool isText(const std::string& bytes) {
  return bytes.find_first_of(std::string("\0\xFE\xFF", 3)) == std::string::npos;
}

/// Whether a list of a YAML text ends in a colon, as `[0, :]` does, or `[0, 1:` at the end of the
/// text. yaml-cpp before 0.7 takes all memory there.
inline bool hasListThatEndsInColon(const std::string& text) {
  const auto begins = std::count(text.begin(), text.end(), '[');
  const bool unclosed = begins > std::count(text.begin(), text.end(), ']');
  for (std::size_t at = text.find(':'); at != std::string::npos; at = text.find(':', at + 1)) {
    const std::size_t next = text.find_first_not_of(" \t\r\n", at + 1);
    if (next == std::string::npos ? unclosed : text[next] == ']') return true;
  }
  return false;
}

}  // namespace camera_self_calibration
