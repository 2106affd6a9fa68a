// COLMAP's cameras.txt. Its pixels are counted from the corner of the image, so that the centre of
// the first one is at (0.5, 0.5).

#include <map>
#include <sstream>
#include <stdexcept>

#include "format_text.h"

namespace camera_self_calibration {
namespace {

constexpr double kOrigin = 0.5;

struct Line {
  std::string model;
  int width = 0;
  int height = 0;
  std::vector<double> values;
};

/// What a model of COLMAP becomes here. `one_focal`: f stands for fx and fy.
struct Meaning {
  CameraModel model;
  bool one_focal;
  std::size_t distortion;  ///< Coefficients in the file.
};

const std::map<std::string, Meaning>& meanings() {
  static const std::map<std::string, Meaning> all = {
      {"SIMPLE_PINHOLE", {CameraModel::kPinhole, true, 0}},
      {"PINHOLE", {CameraModel::kPinhole, false, 0}},
      {"SIMPLE_RADIAL", {CameraModel::kRadtan, true, 1}},
      {"RADIAL", {CameraModel::kRadtan, true, 2}},
      {"OPENCV", {CameraModel::kRadtan, false, 4}},
      {"FULL_OPENCV", {CameraModel::kRadtan, false, 8}},
      {"FOV", {CameraModel::kFov, false, 1}},
      {"SIMPLE_RADIAL_FISHEYE", {CameraModel::kEquidistant, true, 1}},
      {"RADIAL_FISHEYE", {CameraModel::kEquidistant, true, 2}},
      {"OPENCV_FISHEYE", {CameraModel::kEquidistant, false, 4}}};
  return all;
}

std::pair<std::string, Line> parseLine(const std::string& text) {
  std::istringstream words(text);
  std::string id;
  Line line;
  if (!(words >> id >> line.model >> line.width >> line.height)) {
    throw std::runtime_error("the line '" + text +
                             "' is not of the form CAMERA_ID MODEL WIDTH HEIGHT PARAMS");
  }
  double value = 0.0;
  while (words >> value) line.values.push_back(value);
  if (!words.eof()) throw std::runtime_error("'" + text + "' holds something that is no number");
  return {id, line};
}

Camera toCamera(const Line& line) {
  const auto found = meanings().find(line.model);
  if (found == meanings().end()) {
    std::string names;
    for (const auto& [name, meaning] : meanings()) names += " " + name;
    throw std::runtime_error("COLMAP's model " + line.model +
                             " is not supported; these are:" + names);
  }
  const Meaning& meaning = found->second;
  const std::size_t expected = (meaning.one_focal ? 3 : 4) + meaning.distortion;
  if (line.values.size() != expected) {
    throw std::runtime_error(line.model + " has " + std::to_string(expected) +
                             " parameters; there are " + std::to_string(line.values.size()));
  }
  std::vector<double> values = line.values;
  if (meaning.one_focal) values.insert(values.begin(), values.front());
  values[2] -= kOrigin;
  values[3] -= kOrigin;
  const std::vector<double> distortion(values.begin() + 4, values.end());
  values.resize(4);
  if (meaning.model == CameraModel::kRadtan || meaning.model == CameraModel::kPinhole) {
    return makeDistortedCamera(line.width, line.height, values, distortion);
  }
  values.insert(values.end(), distortion.begin(), distortion.end());
  if (meaning.model == CameraModel::kEquidistant) values.resize(8, 0.0);
  return makeCamera(meaning.model, line.width, line.height, values);
}

std::string modelName(const Camera& camera) {
  switch (camera.model()) {
    case CameraModel::kPinhole:
      return "PINHOLE";
    case CameraModel::kFov:
      return "FOV";
    case CameraModel::kRadtan:
      return camera.parameterCount() == 8 ? "OPENCV" : "FULL_OPENCV";
    case CameraModel::kEquidistant:
      return "OPENCV_FISHEYE";
  }
  return {};
}

}  // namespace

StoredCalibration parseColmap(const std::string& text, const std::string& wanted) {
  std::map<std::string, Line> lines;
  std::vector<std::string> names;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string::npos || line[begin] == '#') continue;
    const auto [id, camera] = parseLine(line);
    if (!lines.emplace(id, camera).second) {
      throw std::runtime_error("the camera " + id + " stands there twice");
    }
    names.push_back(id);
  }
  const std::string name = chosenName(names, wanted);
  return {name, toCamera(lines.at(name))};
}

std::string colmapText(const Camera& camera) {
  std::ostringstream text;
  text << "# Camera list with one line of data per camera:\n"
       << "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n"
       << "# Number of cameras: 1\n"
       << "1 " << modelName(camera) << " " << camera.width() << " " << camera.height();
  const Intrinsics& p = camera.parameters();
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    text << " " << exactText(i == 2 || i == 3 ? p[i] + kOrigin : p[i]);
  }
  // FULL_OPENCV goes on with k4, k5, k6.
  if (p.size() == 9) text << " 0 0 0";
  text << "\n";
  return text.str();
}

}  // namespace camera_self_calibration
