// Settings of ORB-SLAM3.

#include <cmath>
#include <stdexcept>

#include "format_text.h"
#include "opencv_storage.h"

namespace camera_self_calibration {
namespace {

std::vector<double> numbers(const OpenCvStorage& storage, const std::string& prefix,
                            const std::vector<const char*>& names) {
  std::vector<double> values;
  values.reserve(names.size());
  for (const char* name : names) values.push_back(storage.number(prefix + name));
  return values;
}

/// "Camera1." for instance. Before version 1.0 of the settings the first camera had no number.
std::string prefixOf(const OpenCvStorage& storage, const std::string& wanted) {
  std::vector<std::string> names;
  for (const char* name : {"Camera1", "Camera2"}) {
    if (storage.has(std::string(name) + ".fx")) names.emplace_back(name);
  }
  if (names.empty()) names.emplace_back("Camera");
  // Settings of a stereo camera mean the first one.
  return chosenName(names, wanted.empty() ? names.front() : wanted) + ".";
}

}  // namespace

StoredCalibration parseOrbSlam3(const std::string& text, const std::string& wanted) {
  const OpenCvStorage storage(text);
  const std::string prefix = prefixOf(storage, wanted);
  const std::string type = storage.has("Camera.type") ? storage.word("Camera.type") : "PinHole";
  const int width = storage.wholeNumber("Camera.width");
  const int height = storage.wholeNumber("Camera.height");
  std::vector<double> values = numbers(storage, prefix, {"fx", "fy", "cx", "cy"});
  if (type == "KannalaBrandt8") {
    const auto k = numbers(storage, prefix, {"k1", "k2", "k3", "k4"});
    values.insert(values.end(), k.begin(), k.end());
    return {prefix.substr(0, prefix.size() - 1),
            makeCamera(CameraModel::kEquidistant, width, height, values)};
  }
  if (type != "PinHole" && type != "Rectified") {
    throw std::runtime_error("'Camera.type' is '" + type +
                             "'; it must be PinHole, KannalaBrandt8 or Rectified");
  }
  std::vector<double> distortion;
  if (type == "PinHole" && storage.has(prefix + "k1")) {
    distortion = numbers(storage, prefix, {"k1", "k2", "p1", "p2"});
    if (storage.has(prefix + "k3")) distortion.push_back(storage.number(prefix + "k3"));
  }
  return {prefix.substr(0, prefix.size() - 1),
          makeDistortedCamera(width, height, values, distortion)};
}

std::string orbSlam3Text(const Camera& camera, const CalibrationLabels& labels) {
  const bool fisheye = camera.model() == CameraModel::kEquidistant;
  std::string text = "%YAML:1.0\n---\nFile.version: \"1.0\"\n";
  text += std::string("Camera.type: \"") + (fisheye ? "KannalaBrandt8" : "PinHole") + "\"\n";
  const std::vector<std::string> names = camera.parameterNames();
  for (int i = 0; i < camera.parameterCount(); ++i) {
    text += "Camera1." + names[static_cast<std::size_t>(i)] + ": " +
            realText(camera.parameters()[i]) + "\n";
  }
  text += "Camera.width: " + std::to_string(camera.width()) +
          "\nCamera.height: " + std::to_string(camera.height()) +
          "\nCamera.fps: " + std::to_string(std::lround(labels.rate_hz)) +
          "\nCamera.RGB: 1\n"
          "# Below: what else ORB-SLAM3 insists on for one camera; adapt it as you like.\n"
          "ORBextractor.nFeatures: 1000\nORBextractor.scaleFactor: 1.2\nORBextractor.nLevels: 8\n"
          "ORBextractor.iniThFAST: 20\nORBextractor.minThFAST: 7\n"
          "Viewer.KeyFrameSize: 0.05\nViewer.KeyFrameLineWidth: 1.0\nViewer.GraphLineWidth: 0.9\n"
          "Viewer.PointSize: 2.0\nViewer.CameraSize: 0.08\nViewer.CameraLineWidth: 3.0\n"
          "Viewer.ViewpointX: 0.0\nViewer.ViewpointY: -0.7\nViewer.ViewpointZ: -1.8\n"
          "Viewer.ViewpointF: 500.0\n";
  return text;
}

}  // namespace camera_self_calibration
