// Kalibr's camchain.

#include <yaml-cpp/yaml.h>

#include <stdexcept>
#include <string>

#include "format_text.h"

namespace camera_self_calibration {
namespace {

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

}  // namespace

StoredCalibration parseKalibr(const std::string& text, const std::string& wanted) {
  const YAML::Node chain = YAML::Load(text);
  if (!chain.IsMap()) throw std::runtime_error("it holds no keys and values");
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
  const YAML::Node camera = nameless ? chain : chain[name];
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
  return {name, makeCamera(model, size[0], size[1], values)};
}

std::string kalibrText(const Camera& camera, const CalibrationLabels& labels,
                       const std::string& name) {
  const Intrinsics& p = camera.parameters();
  return name + ":\n  camera_model: pinhole\n  intrinsics: [" + listText(p, 0, 4) +
         "]\n  distortion_model: " + distortionName(camera.model()) + "\n  distortion_coeffs: [" +
         listText(p, 4, p.size() - 4) + "]\n  resolution: [" + std::to_string(camera.width()) +
         ", " + std::to_string(camera.height()) + "]\n  rostopic: " + labels.topic + "\n";
}

}  // namespace camera_self_calibration
