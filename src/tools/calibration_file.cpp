#include "camera_self_calibration/tools/calibration_file.h"

#include <camera_calibration_parsers/parse_yml.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <iomanip>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/ros/camera_info.h"

namespace camera_self_calibration {
namespace {

std::string contents(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("the calibration file " + path + " cannot be opened");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

Camera fromPlainYaml(const YAML::Node& yaml) {
  const std::string name = yaml["model"].as<std::string>();
  const std::optional<CameraModel> model = cameraModelFromString(name);
  if (!model) {
    throw std::runtime_error("the model '" + name +
                             "' is not one of pinhole, fov, radtan, equidistant");
  }
  const auto values = yaml["params"].as<std::vector<double>>();
  return Camera(*model, yaml["width"].as<int>(), yaml["height"].as<int>(),
                Eigen::Map<const Eigen::VectorXd>(values.data(), values.size()));
}

Camera fromRosYaml(const std::string& text) {
  sensor_msgs::CameraInfo info;
  std::string camera_name;
  std::istringstream stream(text);
  if (!camera_calibration_parsers::readCalibrationYml(stream, camera_name, info)) {
    throw std::runtime_error("it is no calibration in the YAML format of ROS");
  }
  const std::optional<Camera> camera = toCamera(info);
  if (!camera) {
    throw std::runtime_error("its distortion model '" + info.distortion_model +
                             "' or its values cannot be used; plumb_bob and equidistant can");
  }
  return *camera;
}

std::string list(const double* values, Eigen::Index count) {
  std::ostringstream text;
  text << std::setprecision(std::numeric_limits<double>::max_digits10) << "[";
  for (Eigen::Index i = 0; i < count; ++i) text << (i > 0 ? ", " : "") << values[i];
  text << "]";
  return text.str();
}

/// Kalibr's radtan has no k3: a camera with it is fitted by the model that comes closest.
CameraFit withKalibrModel(const Camera& camera) {
  if (camera.model() != CameraModel::kRadtan || camera.parameterCount() == 8) return {camera, {}};
  const std::optional<CameraFit> fit = fitCamera(camera, CameraModel::kEquidistant);
  if (!fit) throw std::runtime_error("the calibration cannot be fitted by a model of Kalibr");
  return *fit;
}

const char* kalibrDistortion(CameraModel model) {
  switch (model) {
    case CameraModel::kPinhole:
      return "none";
    case CameraModel::kFov:
      return "fov";
    case CameraModel::kRadtan:
      return "radtan";
    case CameraModel::kEquidistant:
      return "equidistant";
  }
  return "none";
}

}  // namespace

Camera readCalibrationFile(const std::string& path) {
  const std::string text = contents(path);
  try {
    const YAML::Node yaml = YAML::Load(text);
    if (!yaml.IsMap()) throw std::runtime_error("it holds no keys and values");
    const Camera camera = yaml["model"] ? fromPlainYaml(yaml) : fromRosYaml(text);
    if (!camera.valid()) throw std::runtime_error("its values are out of range");
    return camera;
  } catch (const std::exception& e) {
    throw std::runtime_error("the calibration file " + path + " cannot be used: " + e.what());
  }
}

void writeRosCalibration(const std::string& path, const std::string& camera_name,
                         const Camera& camera) {
  const std::optional<CameraInfoConversion> conversion = toCameraInfo(camera);
  if (!conversion ||
      !camera_calibration_parsers::writeCalibrationYml(path, camera_name, conversion->info)) {
    throw std::runtime_error("the calibration cannot be written to " + path);
  }
}

void writeKalibrCalibration(const std::string& path, const std::string& topic,
                            const Camera& camera) {
  const CameraFit fit = withKalibrModel(camera);
  const Camera& written = fit.camera;
  const Intrinsics& p = written.parameters();
  std::ofstream file(path);
  if (written.model() != camera.model()) {
    file << "# fitted to radtan with k3, which Kalibr does not have: off by " << fit.error.rms
         << " px rms, " << fit.error.max << " px at most\n";
  }
  file << "cam0:\n"
       << "  camera_model: pinhole\n"
       << "  intrinsics: " << list(p.data(), 4) << "\n"
       << "  distortion_model: " << kalibrDistortion(written.model()) << "\n"
       << "  distortion_coeffs: " << list(p.data() + 4, p.size() - 4) << "\n"
       << "  resolution: [" << written.width() << ", " << written.height() << "]\n"
       << "  rostopic: " << topic << "\n";
  if (!file.flush()) throw std::runtime_error("the calibration cannot be written to " + path);
}

}  // namespace camera_self_calibration
