#include "camera_self_calibration/geometry/formatted.h"

#include <algorithm>
#include <cstdarg>
#include <cstddef>
#include <cstdio>

namespace camera_self_calibration {

std::string formatted(const char* format, ...) {
  std::va_list values;
  std::va_list again;
  va_start(values, format);
  va_copy(again, values);
  const int length = std::vsnprintf(nullptr, 0, format, values);
  va_end(values);
  std::string text(static_cast<std::size_t>(std::max(0, length)), '\0');
  // The terminating zero goes where the string's own is.
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  return text;
}

}  // namespace camera_self_calibration
