#include "camera_self_calibration/tools/calibration_format.h"

#include <yaml-cpp/yaml.h>

#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "camera_self_calibration/base/text.h"
#include "camera_self_calibration/camera/fit_without_k3.h"
#include "format_text.h"

namespace camera_self_calibration {
namespace {

const std::array<std::pair<CalibrationFormat, const char*>, 7> kNames = {{
    {CalibrationFormat::kRos, "ros"},
    {CalibrationFormat::kPlain, "plain"},
    {CalibrationFormat::kKalibr, "kalibr"},
    {CalibrationFormat::kOpenCv, "opencv"},
    {CalibrationFormat::kColmap, "colmap"},
    {CalibrationFormat::kOrbSlam3, "orbslam3"},
    {CalibrationFormat::kVins, "vins"},
}};

bool holds(const std::string& text, const char* words) {
  return text.find(words) != std::string::npos;
}

/// Without the comments of YAML: words in them say nothing about the format.
std::string withoutComments(const std::string& text) {
  std::istringstream lines(text);
  std::string rest;
  for (std::string line; std::getline(lines, line);) rest += line.substr(0, line.find('#')) + '\n';
  return rest;
}

/// Files of cv::FileStorage, by their keys; others that only begin as one, such as the camchains of
/// OpenVINS, are told apart as YAML.
std::optional<CalibrationFormat> detectStorage(const std::string& text) {
  if (holds(text, "model_type")) return CalibrationFormat::kVins;
  if (holds(text, "Camera.type") || holds(text, "Camera.fx") || holds(text, "Camera1.fx")) {
    return CalibrationFormat::kOrbSlam3;
  }
  return holds(text, "opencv-matrix") ? std::optional<CalibrationFormat>(CalibrationFormat::kOpenCv)
                                      : std::nullopt;
}

/// Whether the first line that is no comment is an id, a name in capitals and a size.
bool looksLikeColmap(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line)) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin != std::string::npos && line[begin] != '#') break;
  }
  std::istringstream words(line);
  int id = 0;
  int width = 0;
  int height = 0;
  std::string model;
  return (words >> id >> model >> width >> height) &&
         model.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_") == std::string::npos;
}

void refuseEndless(const std::string& text) {
  if (hasListThatEndsInColon(text)) throw std::runtime_error("a list in it ends in a colon");
}

std::optional<CalibrationFormat> detectYaml(const std::string& text) {
  refuseEndless(text);
  YAML::Node yaml;
  try {
    yaml = YAML::Load(withoutStorageHeader(text));
  } catch (const YAML::Exception& e) {
    throw std::runtime_error(std::string("it is no valid YAML: ") + e.what());
  }
  if (!yaml.IsMap()) return std::nullopt;
  if (yaml["model_type"]) return CalibrationFormat::kVins;
  if (yaml["model"]) return CalibrationFormat::kPlain;
  const bool ros = yaml["camera_matrix"] || yaml["image_width"] || yaml["K"];
  if (ros) return CalibrationFormat::kRos;
  if (yaml["camera_model"] && yaml["resolution"]) return CalibrationFormat::kKalibr;
  for (const auto& entry : yaml) {
    if (entry.second.IsMap() && entry.second["camera_model"]) return CalibrationFormat::kKalibr;
  }
  return std::nullopt;
}

bool hasModel(CalibrationFormat format, const Camera& camera) {
  const CameraModel model = camera.model();
  switch (format) {
    case CalibrationFormat::kPlain:
    case CalibrationFormat::kColmap:
      return true;
    case CalibrationFormat::kRos:
    case CalibrationFormat::kOpenCv:
    case CalibrationFormat::kOrbSlam3:
      return model != CameraModel::kFov;
    case CalibrationFormat::kKalibr:
      return model != CameraModel::kRadtan || camera.parameterCount() == 8;
    case CalibrationFormat::kVins:
      return model != CameraModel::kFov &&
             (model != CameraModel::kRadtan || camera.parameterCount() == 8);
  }
  return false;
}

/// What lacks fov or k3 has equidistant, and what lacks k3 alone has radtan without it.
std::optional<CameraFit> bestFit(const Camera& camera, CalibrationFormat format) {
  const std::optional<CameraFit> fit = fitCamera(camera, CameraModel::kEquidistant);
  if (camera.model() != CameraModel::kRadtan) return fit;
  const std::optional<CameraFit> without_k3 = fitWithoutK3(camera);
  if (!without_k3 || !hasModel(format, without_k3->camera)) return fit;
  return !fit || without_k3->error.rms < fit->error.rms ? without_k3 : fit;
}

bool namesCameras(CalibrationFormat format) {
  return format == CalibrationFormat::kKalibr || format == CalibrationFormat::kColmap ||
         format == CalibrationFormat::kOpenCv || format == CalibrationFormat::kOrbSlam3;
}

/// k3 = 0 says nothing.
Camera withoutIdleK3(const Camera& camera) {
  const Intrinsics& p = camera.parameters();
  if (camera.model() != CameraModel::kRadtan || p.size() != 9 || p[8] != 0.0) return camera;
  return Camera(CameraModel::kRadtan, camera.width(), camera.height(), p.head(8));
}

}  // namespace

std::string toString(CalibrationFormat format) {
  for (const auto& [known, name] : kNames) {
    if (known == format) return name;
  }
  return {};
}

std::optional<CalibrationFormat> calibrationFormatFromString(const std::string& name) {
  for (const auto& [format, known] : kNames) {
    if (name == known) return format;
  }
  return std::nullopt;
}

std::string calibrationFormatNames() {
  std::string all;
  for (const auto& [format, name] : kNames) all += (all.empty() ? "" : ", ") + std::string(name);
  return all;
}

std::optional<CalibrationFormat> detectCalibrationFormat(const std::string& text) {
  const bool xml = text.compare(0, 5, "<?xml") == 0;
  if (xml || text.compare(0, 5, "%YAML") == 0) {
    const std::optional<CalibrationFormat> format =
        detectStorage(xml ? text : withoutComments(text));
    if (format || xml) return format;
  }
  if (looksLikeColmap(text)) return CalibrationFormat::kColmap;
  return detectYaml(text);
}

StoredCalibration parseCalibration(const std::string& text, CalibrationFormat format,
                                   const std::string& wanted) {
  if (!wanted.empty() && !namesCameras(format)) {
    throw std::runtime_error("--camera has no meaning for a file of the format " +
                             toString(format) + ", which does not name its cameras");
  }
  refuseEndless(text);
  switch (format) {
    case CalibrationFormat::kRos:
      return parseRos(withoutStorageHeader(text));
    case CalibrationFormat::kPlain:
      return parsePlain(text);
    case CalibrationFormat::kKalibr:
      return parseKalibr(withoutStorageHeader(text), wanted);
    case CalibrationFormat::kOpenCv:
      return parseOpenCv(text, wanted);
    case CalibrationFormat::kColmap:
      return parseColmap(text, wanted);
    case CalibrationFormat::kOrbSlam3:
      return parseOrbSlam3(text, wanted);
    case CalibrationFormat::kVins:
      return parseVins(text);
  }
  throw std::runtime_error("the format is not known");
}

Rig parseRigCalibration(const std::string& text) {
  if (detectCalibrationFormat(text) != CalibrationFormat::kKalibr) {
    throw std::runtime_error("it is no camchain of Kalibr, which says where the cameras sit");
  }
  refuseEndless(text);
  return parseKalibrRig(withoutStorageHeader(text));
}

CameraFit storable(const Camera& camera, CalibrationFormat format) {
  const Camera plain = withoutIdleK3(camera);
  if (hasModel(format, plain)) return {plain, {}};
  const std::optional<CameraFit> fit = bestFit(plain, format);
  if (!fit) {
    throw std::runtime_error("the calibration cannot be fitted by a model of the format " +
                             toString(format));
  }
  if (!std::isfinite(fit->error.max)) {
    throw std::runtime_error("no model of the format " + toString(format) +
                             " reaches the whole image of this " + toString(camera.model()) +
                             " camera");
  }
  return *fit;
}

std::string fitNote(const Camera& camera, const PixelError& error) {
  if (error.max == 0.0) return {};
  return "fitted to " + toString(camera.model()) +
         (camera.parameterCount() == kMaxIntrinsics ? " with k3: " : ": ") + offBy(error);
}

std::string approximationNote(const std::string& holder, const Camera& camera,
                              CalibrationFormat format, const CameraFit& fit) {
  if (fit.error.max < kNoticeablePx) return {};
  return holder + " holds an approximation, since " + toString(format) + " has no " +
         toString(camera.model()) + " lens like this: " + toString(fit.camera.model()) + ", " +
         offBy(fit.error) + ".";
}

std::string calibrationText(const Camera& camera, CalibrationFormat format,
                            const CalibrationLabels& labels) {
  switch (format) {
    case CalibrationFormat::kRos:
      return rosText(camera, labels);
    case CalibrationFormat::kPlain:
      return plainText(camera);
    case CalibrationFormat::kKalibr:
      return kalibrText(camera, labels);
    case CalibrationFormat::kOpenCv:
      return openCvText(camera);
    case CalibrationFormat::kColmap:
      return colmapText(camera);
    case CalibrationFormat::kOrbSlam3:
      return orbSlam3Text(camera, labels);
    case CalibrationFormat::kVins:
      return vinsText(camera, labels);
  }
  throw std::runtime_error("the format is not known");
}

}  // namespace camera_self_calibration
