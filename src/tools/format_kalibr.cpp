// Kalibr's camchain.

#include <yaml-cpp/yaml.h>

#include <stdexcept>
#include <string>

#include "format_text.h"

namespace camera_self_calibration {
namespace {

constexpr double kRounding = 1e-3;  // of the numbers of a rotation

std::string distortionName(CameraModel model) {
  return model == CameraModel::kPinhole ? "none" : toString(model);
}

/// EuRoC's sensor.yaml and OpenVINS have other names for the same.
CameraModel modelOf(const std::string& projection, const std::string& distortion) {
  if (projection != "pinhole") {
    throw std::runtime_error("the camera_model '" + projection +
                             "' is not supported; calibrate with Kalibr's pinhole models");
  }
  for (const CameraModel model : {CameraModel::kPinhole, CameraModel::kFov, CameraModel::kRadtan,
                                  CameraModel::kEquidistant}) {
    if (distortion == distortionName(model)) return model;
  }
  if (distortion == "radial-tangential" || distortion == "plumb_bob") return CameraModel::kRadtan;
  throw std::runtime_error("the distortion_model '" + distortion +
                           "' is not one of none, fov, radtan, equidistant");
}

template <typename T>
T value(const YAML::Node& camera, const char* key) {
  if (!camera[key]) throw std::runtime_error(std::string("'") + key + "' is missing");
  return camera[key].as<T>();
}

Camera cameraOf(const YAML::Node& camera) {
  const CameraModel model = modelOf(value<std::string>(camera, "camera_model"),
                                    value<std::string>(camera, "distortion_model"));
  auto values = value<std::vector<double>>(camera, "intrinsics");
  if (values.size() != 4) throw std::runtime_error("'intrinsics' must hold fx, fy, cx, cy");
  // Left out or given as zeros where there is none.
  std::vector<double> coefficients;
  if (model != CameraModel::kPinhole) {
    const bool euroc = camera["distortion_coefficients"].IsDefined();
    coefficients =
        value<std::vector<double>>(camera, euroc ? "distortion_coefficients" : "distortion_coeffs");
  }
  values.insert(values.end(), coefficients.begin(), coefficients.end());
  const auto size = value<std::vector<int>>(camera, "resolution");
  if (size.size() != 2) throw std::runtime_error("'resolution' must hold width and height");
  return makeCamera(model, size[0], size[1], values);
}

YAML::Node chainOf(const std::string& text) {
  YAML::Node chain = YAML::Load(text);
  if (!chain.IsMap()) throw std::runtime_error("it holds no keys and values");
  return chain;
}

/// T_cn_cnm1 of the camera of this name.
Rigid3 motionOf(const YAML::Node& camera, const std::string& name) {
  if (!camera["T_cn_cnm1"]) {
    throw std::runtime_error("'" + name + "' has no T_cn_cnm1, which says where it sits");
  }
  const auto rows = camera["T_cn_cnm1"].as<std::vector<std::vector<double>>>();
  const std::string shape = "'T_cn_cnm1' of '" + name + "' is no motion of 4 x 4 numbers";
  if (rows.size() != 4) throw std::runtime_error(shape);
  Eigen::Matrix4d motion;
  for (int r = 0; r < 4; ++r) {
    if (rows[r].size() != 4) throw std::runtime_error(shape);
    motion.row(r) = Eigen::RowVector4d(rows[r].data());
  }
  const Eigen::Matrix3d rotation = motion.topLeftCorner<3, 3>();
  const double skewed = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!motion.allFinite() || !(skewed < kRounding) || rotation.determinant() < 0.0) {
    throw std::runtime_error(shape);
  }
  return {Eigen::Quaterniond(rotation).normalized(), motion.topRightCorner<3, 1>()};
}

}  // namespace

StoredCalibration parseKalibr(const std::string& text, const std::string& wanted) {
  const YAML::Node chain = chainOf(text);
  // EuRoC's sensor.yaml is one camera without a name.
  const bool nameless = chain["camera_model"].IsDefined();
  if (nameless && !wanted.empty()) {
    throw std::runtime_error("its only camera has no name; leave out --camera");
  }
  std::vector<std::string> names;
  for (const auto& entry : chain) {
    if (entry.second.IsMap()) names.push_back(entry.first.as<std::string>());
  }
  const std::string name = nameless ? "" : chosenName(names, wanted);
  return {name, cameraOf(nameless ? chain : chain[name])};
}

Rig parseKalibrRig(const std::string& text) {
  const YAML::Node chain = chainOf(text);
  Rig rig;
  for (std::string name = "cam0"; chain[name].IsDefined(); name = formatted("cam%d", rig.size())) {
    const YAML::Node camera = chain[name];
    rig.cameras.push_back(cameraOf(camera));
    const bool first = rig.rig_from_camera.empty();
    rig.rig_from_camera.push_back(
        first ? Rigid3() : rig.rig_from_camera.back() * motionOf(camera, name).inverse());
  }
  if (rig.size() < 2) throw std::runtime_error("it does not hold cam0 and cam1");
  return rig;
}

std::string kalibrText(const Camera& camera, const CalibrationLabels& labels,
                       const std::string& name) {
  const Intrinsics& p = camera.parameters();
  return name + ":\n  camera_model: pinhole\n  intrinsics: [" + listText(p, 0, 4) +
         "]\n  distortion_model: " + distortionName(camera.model()) + "\n  distortion_coeffs: [" +
         listText(p, 4, p.size() - 4) + "]\n  resolution: [" + std::to_string(camera.width()) +
         ", " + std::to_string(camera.height()) + "]\n  rostopic: " + wordText(labels.topic, "/") +
         "\n";
}

}  // namespace camera_self_calibration
