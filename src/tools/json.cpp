#include "camera_self_calibration/tools/json.h"

#include <cmath>
#include <cstdlib>

#include "camera_self_calibration/base/formatted.h"

namespace camera_self_calibration::json {
namespace {

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) {
    if (!text.empty()) text += ", ";
    text += part;
  }
  return text;
}

std::string escaped(char c) {
  switch (c) {
    case '"':
      return "\\\"";
    case '\\':
      return "\\\\";
    case '\n':
      return "\\n";
    case '\t':
      return "\\t";
    default:
      break;
  }
  if (static_cast<unsigned char>(c) >= 0x20) return std::string(1, c);
  return formatted("\\u%04x", static_cast<unsigned>(c));
}

}  // namespace

std::string number(double value) {
  if (!std::isfinite(value)) return "null";
  std::string text;
  for (int digits = 6; digits <= 17; ++digits) {
    text = formatted("%.*g", digits, value);
    if (std::strtod(text.c_str(), nullptr) == value) break;
  }
  return text;
}

std::string number(std::int64_t value) { return std::to_string(value); }

std::string seconds(std::int64_t nanoseconds) {
  const std::int64_t magnitude = std::abs(nanoseconds);
  return formatted("%s%lld.%09lld", nanoseconds < 0 ? "-" : "",
                   static_cast<long long>(magnitude / 1000000000),
                   static_cast<long long>(magnitude % 1000000000));
}

std::string string(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += escaped(c);
  return quoted + "\"";
}

std::string array(const std::vector<std::string>& values) { return "[" + joined(values) + "]"; }

std::string object(const std::vector<Member>& members) {
  std::vector<std::string> parts;
  parts.reserve(members.size());
  for (const auto& [key, value] : members) parts.push_back(string(key) + ": " + value);
  return "{" + joined(parts) + "}";
}

}  // namespace camera_self_calibration::json
