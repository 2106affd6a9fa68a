// The YAML of ROS, and the plain one.

#include <camera_calibration_parsers/parse_yml.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "camera_self_calibration/ros/calibration_yaml.h"
#include "camera_self_calibration/ros/camera_info.h"
#include "camera_self_calibration/ros/model_conversion.h"
#include "camera_self_calibration/ros/sensor_window.h"
#include "format_text.h"

namespace camera_self_calibration {
namespace {

/// Values of a list under a key, of this number (or any, if it is 0).
std::vector<double> list(const YAML::Node& yaml, const char* key, std::size_t count) {
  const auto values = neededValue(yaml, key).as<std::vector<double>>();
  if (count == 0 || values.size() == count) return values;
  throw std::runtime_error(std::string("'") + key + "' has " + std::to_string(values.size()) +
                           " values, not " + std::to_string(count));
}

/// 0, which stands for the default in a CameraInfo, where it is not there.
std::uint32_t orZero(const YAML::Node& yaml, const char* key) {
  const YAML::Node value = yaml[key];
  return value ? value.as<std::uint32_t>() : 0;
}

/// A sensor_msgs/CameraInfo as rostopic prints it.
sensor_msgs::CameraInfo messageOf(const YAML::Node& yaml) {
  sensor_msgs::CameraInfo info;
  info.width = neededValue(yaml, "width").as<std::uint32_t>();
  info.height = neededValue(yaml, "height").as<std::uint32_t>();
  info.distortion_model = neededValue(yaml, "distortion_model").as<std::string>();
  info.D = list(yaml, "D", 0);
  const std::vector<double> k = list(yaml, "K", 9);
  std::copy(k.begin(), k.end(), info.K.begin());
  info.binning_x = orZero(yaml, "binning_x");
  info.binning_y = orZero(yaml, "binning_y");
  if (const YAML::Node roi = yaml["roi"]; roi && roi.IsMap()) {
    info.roi.x_offset = orZero(roi, "x_offset");
    info.roi.y_offset = orZero(roi, "y_offset");
    info.roi.width = orZero(roi, "width");
    info.roi.height = orZero(roi, "height");
  }
  if (yaml["R"]) {
    const std::vector<double> r = list(yaml, "R", 9);
    std::copy(r.begin(), r.end(), info.R.begin());
  }
  if (yaml["P"]) {
    const std::vector<double> p = list(yaml, "P", 12);
    std::copy(p.begin(), p.end(), info.P.begin());
  }
  return info;
}

/// Whether a stereo calibration or a choice of the rectified image stands in R and P.
bool hasRectification(const sensor_msgs::CameraInfo& info) {
  const auto& p = info.P;
  if (p[0] == 0.0) return false;
  const bool other_view =
      p[0] != info.K[0] || p[5] != info.K[4] || p[2] != info.K[2] || p[6] != info.K[5];
  return other_view || isOfAPair(info);
}

/// Whether images are binned, or show a part of the sensor.
bool hasWindow(const sensor_msgs::CameraInfo& info) {
  const std::optional<SensorWindow> window = sensorWindow(info);
  return !window || window->imageWidth() != window->full_width ||
         window->imageHeight() != window->full_height;
}

}  // namespace

StoredCalibration parseRos(const std::string& text) {
  sensor_msgs::CameraInfo info;
  StoredCalibration stored;
  // The first document, since rostopic ends a message with "---". LoadAll() does not end on all
  // texts.
  const YAML::Node first = YAML::Load(text);
  if (first.IsMap() && first["K"]) {
    info = messageOf(first);
  } else {
    const NamedCameraInfo named = parseCalibrationYaml(text);
    info = named.info;
    stored.name = named.name;
    if (!first["camera_name"]) stored.name.clear();  // the parser makes one up
  }
  const std::optional<Camera> camera = toCamera(info);
  if (!camera) {
    const std::string problem = whyNoCamera(info);
    if (problem.empty()) refuseRational();
    throw std::runtime_error(problem);
  }
  const Intrinsics& p = camera->parameters();
  stored.camera = makeCamera(camera->model(), camera->width(), camera->height(),
                             std::vector<double>(p.data(), p.data() + p.size()));
  stored.rectified = hasRectification(info);
  stored.windowed = hasWindow(info);
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
  const std::string name = neededValue(yaml, "model").as<std::string>();
  const std::optional<CameraModel> model = cameraModelFromString(name);
  if (!model) {
    throw std::runtime_error("the model '" + name +
                             "' is not one of pinhole, fov, radtan (or plumb_bob), equidistant");
  }
  return {{},
          makeCamera(*model, neededValue(yaml, "width").as<int>(),
                     neededValue(yaml, "height").as<int>(),
                     neededValue(yaml, "params").as<std::vector<double>>())};
}

std::string plainText(const Camera& camera) {
  const Intrinsics& p = camera.parameters();
  return "model: " + toString(camera.model()) + "\nwidth: " + std::to_string(camera.width()) +
         "\nheight: " + std::to_string(camera.height()) + "\nparams: [" + listText(p, 0, p.size()) +
         "]\n";
}

}  // namespace camera_self_calibration
