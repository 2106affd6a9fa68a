#include "camera_self_calibration/ros/calibration_yaml.h"

#include <camera_calibration_parsers/parse_yml.h>

#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "camera_self_calibration/base/text.h"

namespace camera_self_calibration {
namespace {

/// A matrix whose size and values agree; `rows` and `columns` of -1 may be any.
void checkMatrix(const YAML::Node& yaml, const char* key, int rows, int columns) {
  const YAML::Node matrix = neededValue(yaml, key);
  if (!matrix.IsMap()) throw std::runtime_error(std::string("'") + key + "' is no matrix");
  const int found_rows = neededValue(matrix, "rows").as<int>();
  const int found_columns = neededValue(matrix, "cols").as<int>();
  const auto count =
      static_cast<std::int64_t>(neededValue(matrix, "data").as<std::vector<double>>().size());
  const bool size_fits =
      (rows < 0 || found_rows == rows) && (columns < 0 || found_columns == columns);
  if (size_fits && std::int64_t{found_rows} * found_columns == count) return;
  throw std::runtime_error(std::string("'") + key + "' of " + std::to_string(found_rows) + " x " +
                           std::to_string(found_columns) + " has " + std::to_string(count) +
                           " values");
}

/// The parser of ROS ends the process where a matrix has an unexpected size.
void checkKeys(const YAML::Node& yaml) {
  if (!yaml.IsMap()) throw std::runtime_error("it holds no keys and values");
  for (const char* key : {"image_width", "image_height"}) {
    if (neededValue(yaml, key).as<int>() <= 0) {
      throw std::runtime_error(std::string("'") + key + "' is not positive");
    }
  }
  checkMatrix(yaml, "camera_matrix", 3, 3);
  checkMatrix(yaml, "rectification_matrix", 3, 3);
  checkMatrix(yaml, "projection_matrix", 3, 4);
  checkMatrix(yaml, "distortion_coefficients", -1, -1);
}

}  // namespace

YAML::Node neededValue(const YAML::Node& yaml, const char* key) {
  const YAML::Node value = yaml[key];
  if (!value) throw std::runtime_error(std::string("'") + key + "' is missing");
  return value;
}

NamedCameraInfo parseCalibrationYaml(const std::string& text) {
  if (!isText(text) || hasListThatEndsInColon(text)) throw std::runtime_error("it is no YAML");
  checkKeys(YAML::Load(text));
  NamedCameraInfo result;
  std::istringstream in(text);
  if (!camera_calibration_parsers::readCalibrationYml(in, result.name, result.info)) {
    throw std::runtime_error("it is no calibration in the YAML format of ROS");
  }
  return result;
}

}  // namespace camera_self_calibration
