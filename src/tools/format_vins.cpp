// The camera files of VINS-Mono and VINS-Fusion (camodocal).

#include <stdexcept>

#include "format_text.h"
#include "opencv_storage.h"

namespace camera_self_calibration {
namespace {

constexpr const char* kProjection = "projection_parameters";
constexpr const char* kDistortion = "distortion_parameters";

std::vector<double> numbers(const OpenCvStorage& storage, const char* group,
                            const std::vector<const char*>& names) {
  std::vector<double> values;
  values.reserve(names.size());
  for (const char* name : names) values.push_back(storage.numberIn(group, name));
  return values;
}

std::string groupText(const std::string& group, const std::vector<const char*>& names,
                      const Intrinsics& values, Eigen::Index first) {
  std::string text = group + ":\n";
  for (const char* name : names) {
    text += "   " + std::string(name) + ": " + exactText(values[first++]) + "\n";
  }
  return text;
}

}  // namespace

StoredCalibration parseVins(const std::string& text) {
  const OpenCvStorage storage(text);
  const std::string type = storage.word("model_type");
  const std::string name = storage.has("camera_name") ? storage.word("camera_name") : "";
  const int width = storage.wholeNumber("image_width");
  const int height = storage.wholeNumber("image_height");
  if (type == "KANNALA_BRANDT") {
    // r = theta + k2 theta^3 + k3 theta^5 + ...: their k2 is the first coefficient.
    std::vector<double> values = numbers(storage, kProjection, {"mu", "mv", "u0", "v0"});
    const auto k = numbers(storage, kProjection, {"k2", "k3", "k4", "k5"});
    values.insert(values.end(), k.begin(), k.end());
    return {name, makeCamera(CameraModel::kEquidistant, width, height, values)};
  }
  if (type != "PINHOLE") {
    throw std::runtime_error("'model_type' is '" + type +
                             "'; only PINHOLE and KANNALA_BRANDT are supported");
  }
  const auto values = numbers(storage, kProjection, {"fx", "fy", "cx", "cy"});
  const auto distortion = numbers(storage, kDistortion, {"k1", "k2", "p1", "p2"});
  return {name, makeDistortedCamera(width, height, values, distortion)};
}

std::string vinsText(const Camera& camera, const CalibrationLabels& labels) {
  const bool fisheye = camera.model() == CameraModel::kEquidistant;
  std::string text = "%YAML:1.0\n---\nmodel_type: ";
  text += fisheye ? "KANNALA_BRANDT" : "PINHOLE";
  text += "\ncamera_name: " + wordText(labels.camera_name) +
          "\nimage_width: " + std::to_string(camera.width()) +
          "\nimage_height: " + std::to_string(camera.height()) + "\n";
  Intrinsics p = camera.parameters();
  if (fisheye) {
    return text + groupText(kProjection, {"mu", "mv", "u0", "v0", "k2", "k3", "k4", "k5"}, p, 0);
  }
  if (p.size() == 4) {
    p.conservativeResize(8);
    p.tail(4).setZero();
  }
  return text + groupText(kDistortion, {"k1", "k2", "p1", "p2"}, p, 4) +
         groupText(kProjection, {"fx", "fy", "cx", "cy"}, p, 0);
}

}  // namespace camera_self_calibration
