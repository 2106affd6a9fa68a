#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace camera_self_calibration {

/// Members keep their order. What is not a finite number becomes null.
using Json = nlohmann::ordered_json;

/// The text of a file. Bytes that are no UTF-8, as a file name may hold, are replaced.
inline std::string toText(const Json& value) {
  return value.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace camera_self_calibration
