// The YAML of ROS, and the plain one.

#include <camera_calibration_parsers/parse_yml.h>
#include <yaml-cpp/yaml.h>

#include <sstream>
#include <stdexcept>

#include "camera_self_calibration/ros/camera_info.h"
#include "format_text.h"

namespace camera_self_calibration {
namespace {

YAML::Node need(const YAML::Node& yaml, const char* key) {
  const YAML::Node value = yaml[key];
  if (!value) throw std::runtime_error(std::string("'") + key + "' is missing");
  return value;
}

/// A matrix whose size and values agree; `rows` and `columns` of -1 may be any.
void checkMatrix(const YAML::Node& yaml, const char* key, int rows, int columns) {
  const YAML::Node matrix = need(yaml, key);
  if (!matrix.IsMap()) throw std::runtime_error(std::string("'") + key + "' is no matrix");
  const int found_rows = need(matrix, "rows").as<int>();
  const int found_columns = need(matrix, "cols").as<int>();
  const auto count = static_cast<int>(need(matrix, "data").as<std::vector<double>>().size());
  const bool size_fits =
      (rows < 0 || found_rows == rows) && (columns < 0 || found_columns == columns);
  if (size_fits && found_rows * found_columns == count) return;
  throw std::runtime_error(std::string("'") + key + "' of " + std::to_string(found_rows) + " x " +
                           std::to_string(found_columns) + " has " + std::to_string(count) +
                           " values");
}

/// The parser of ROS ends the process where a matrix has an unexpected size.
void checkRosKeys(const std::string& text) {
  const YAML::Node yaml = YAML::Load(text);
  if (!yaml.IsMap()) throw std::runtime_error("it holds no keys and values");
  for (const char* key : {"image_width", "image_height"}) {
    if (need(yaml, key).as<int>() <= 0) {
      throw std::runtime_error(std::string("'") + key + "' is not positive");
    }
  }
  checkMatrix(yaml, "camera_matrix", 3, 3);
  checkMatrix(yaml, "rectification_matrix", 3, 3);
  checkMatrix(yaml, "projection_matrix", 3, 4);
  checkMatrix(yaml, "distortion_coefficients", -1, -1);
}

}  // namespace

StoredCalibration parseRos(const std::string& text) {
  checkRosKeys(text);
  sensor_msgs::CameraInfo info;
  StoredCalibration stored;
  std::istringstream stream(text);
  if (!camera_calibration_parsers::readCalibrationYml(stream, stored.name, info)) {
    throw std::runtime_error("it is no calibration in the YAML format of ROS");
  }
  const std::optional<Camera> camera = toCamera(info);
  if (!camera) {
    throw std::runtime_error("its distortion model '" + info.distortion_model +
                             "' or its values cannot be used; plumb_bob and equidistant can");
  }
  stored.camera = *camera;
  return stored;
}

std::string rosText(const Camera& camera, const CalibrationLabels& labels) {
  const std::optional<CameraInfoConversion> conversion = toCameraInfo(camera);
  std::ostringstream text;
  if (!conversion || !camera_calibration_parsers::writeCalibrationYml(text, labels.camera_name,
                                                                      conversion->info)) {
    throw std::runtime_error("the calibration cannot be written in the YAML format of ROS");
  }
  return text.str();
}

StoredCalibration parsePlain(const std::string& text) {
  const YAML::Node yaml = YAML::Load(text);
  const std::string name = need(yaml, "model").as<std::string>();
  const std::optional<CameraModel> model = cameraModelFromString(name);
  if (!model) {
    throw std::runtime_error("the model '" + name +
                             "' is not one of pinhole, fov, radtan, equidistant");
  }
  return {{},
          makeCamera(*model, need(yaml, "width").as<int>(), need(yaml, "height").as<int>(),
                     need(yaml, "params").as<std::vector<double>>())};
}

std::string plainText(const Camera& camera) {
  const Intrinsics& p = camera.parameters();
  return "model: " + toString(camera.model()) + "\nwidth: " + std::to_string(camera.width()) +
         "\nheight: " + std::to_string(camera.height()) + "\nparams: [" + listText(p, 0, p.size()) +
         "]\n";
}

}  // namespace camera_self_calibration
