#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace camera_self_calibration::json {

/// The functions return JSON text, which the composing ones take as values.
using Member = std::pair<std::string, std::string>;  ///< Key (plain) and value (JSON text).

/// Shortest text that reads back as the same double; null for what is not a finite number.
std::string number(double value);
std::string number(std::int64_t value);

/// Seconds with nine decimals, exact for any stamp.
std::string seconds(std::int64_t nanoseconds);

std::string string(const std::string& text);
std::string array(const std::vector<std::string>& values);
std::string object(const std::vector<Member>& members);

}  // namespace camera_self_calibration::json
