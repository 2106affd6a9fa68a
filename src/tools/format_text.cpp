#include "format_text.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "camera_self_calibration/camera/image_size.h"
#include "camera_self_calibration/camera/plausibility.h"

namespace camera_self_calibration {

std::string listText(const Intrinsics& values, Eigen::Index first, Eigen::Index count) {
  std::string text;
  for (Eigen::Index i = 0; i < count; ++i)
    text += (i > 0 ? ", " : "") + realText(values[first + i]);
  return text;
}

std::string wordText(const std::string& word, const std::string& also_plain) {
  const auto isPlain = [&also_plain](char c) {
    return c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           also_plain.find(c) != std::string::npos;
  };
  const bool number = word.empty() || std::isdigit(static_cast<unsigned char>(word.front())) != 0;
  if (!number && std::all_of(word.begin(), word.end(), isPlain)) return word;
  std::string text;
  for (const char c : word) {
    if (c == '"' || c == '\\') text += '\\';
    text += c == '\n' ? "\\n" : std::string(1, c);
  }
  return '"' + text + '"';
}

std::string offBy(const PixelError& error) {
  return formatted("off by %.3g px rms, %.3g px at most", error.rms, error.max);
}

std::string withoutStorageHeader(const std::string& text) {
  if (text.compare(0, 6, "%YAML:") != 0) return text;
  const std::size_t end = text.find('\n');
  return end == std::string::npos ? std::string() : text.substr(end + 1);
}

Camera makeCamera(CameraModel model, int width, int height, const std::vector<double>& values) {
  if (!isImageSize(width, height)) {
    throw std::runtime_error("the image size " + std::to_string(width) + " x " +
                             std::to_string(height) +
                             (width <= 0 || height <= 0 ? " is not positive" : " is too large"));
  }
  const auto expected = static_cast<std::size_t>(Camera::parameterCount(model));
  const bool with_k3 = model == CameraModel::kRadtan && values.size() == expected + 1;
  if (values.size() != expected && !with_k3) {
    throw std::runtime_error("there are " + std::to_string(values.size()) + " parameters; " +
                             toString(model) + " has " + std::to_string(expected));
  }
  const Camera camera(
      model, width, height,
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  if (!camera.valid()) {
    throw std::runtime_error("its values are out of range: " +
                             listText(camera.parameters(), 0, camera.parameterCount()));
  }
  const std::string problem = implausibility(camera);
  if (!problem.empty()) throw std::runtime_error(problem);
  return camera;
}

void refuseRational() {
  throw std::runtime_error(
      "it has the coefficients k4, k5, k6 or more, which none of the models pinhole, fov, radtan, "
      "equidistant has");
}

Camera makeDistortedCamera(int width, int height, const std::vector<double>& focal_and_centre,
                           const std::vector<double>& coefficients) {
  std::vector<double> values = focal_and_centre;
  std::vector<double> distortion = coefficients;
  while (!distortion.empty() && distortion.back() == 0.0) distortion.pop_back();
  if (distortion.empty()) return makeCamera(CameraModel::kPinhole, width, height, values);
  if (distortion.size() > 5) refuseRational();
  distortion.resize(std::max<std::size_t>(4, distortion.size()), 0.0);
  values.insert(values.end(), distortion.begin(), distortion.end());
  return makeCamera(CameraModel::kRadtan, width, height, values);
}

std::string chosenName(const std::vector<std::string>& names, const std::string& wanted) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  if (names.empty()) throw std::runtime_error("it holds no camera");
  if (wanted.empty()) {
    if (names.size() == 1) return names.front();
    throw std::runtime_error("it holds several cameras (" + all +
                             "); choose one with --camera, or the option for this file");
  }
  if (std::find(names.begin(), names.end(), wanted) == names.end()) {
    throw std::runtime_error("it has no camera '" + wanted + "'; there is " + all);
  }
  return wanted;
}

}  // namespace camera_self_calibration
