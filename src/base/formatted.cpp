#include "camera_self_calibration/base/formatted.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

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

std::string withFullStop(const std::string& text) {
  const bool ends = text.empty() || std::string(".!?").find(text.back()) != std::string::npos;
  return ends ? text : text + ".";
}

std::string asSentence(const std::string& text) {
  std::string sentence = text;
  if (sentence.empty()) return sentence;
  const auto isLower = [](char c) { return c >= 'a' && c <= 'z'; };
  const std::size_t word = std::min(sentence.find_first_of(" ,:;."), sentence.size());
  // camera_info and the like are names.
  if (std::all_of(sentence.begin(), sentence.begin() + static_cast<std::ptrdiff_t>(word),
                  isLower)) {
    sentence[0] = static_cast<char>(sentence[0] - 'a' + 'A');
  }
  return withFullStop(sentence);
}

std::string sentencesOf(const std::string& text, const std::string& more) {
  return asSentence(text) + (text.empty() || more.empty() ? "" : " ") + asSentence(more);
}

std::string exactText(double value) {
  std::string text;
  for (int digits = 6; digits <= 17; ++digits) {
    text = formatted("%.*g", digits, value);
    if (std::strtod(text.c_str(), nullptr) == value) break;
  }
  return text;
}

std::string realText(double value) {
  std::string text = exactText(value);
  if (std::isfinite(value) && text.find('.') == std::string::npos) {
    text.insert(std::min(text.find('e'), text.size()), ".0");
  }
  return text;
}

std::string stampText(std::int64_t nanoseconds) {
  const std::int64_t magnitude = std::abs(nanoseconds);
  return formatted("%s%lld.%09lld", nanoseconds < 0 ? "-" : "",
                   static_cast<long long>(magnitude / 1000000000),
                   static_cast<long long>(magnitude % 1000000000));
}

std::string sizeText(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

}  // namespace camera_self_calibration
