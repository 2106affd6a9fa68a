#include "camera_self_calibration/tools/calibration_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "camera_self_calibration/base/text.h"
#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {
namespace {

// A calibration is a page of text; who gives a bag or an image by mistake need not wait.
constexpr std::size_t kMaxBytes = 1 << 20;

[[noreturn]] void throwUnusable(const std::string& path, const std::string& as,
                                const std::string& why) {
  throw std::runtime_error("the calibration file " + path + " cannot be used" + as + ": " + why);
}

std::string contents(const std::string& path) {
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) {
    throw std::runtime_error("the calibration file " + path + " is a folder");
  }
  std::string text(kMaxBytes + 1, '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw std::runtime_error("the calibration file " + path +
                             " cannot be opened: " + std::strerror(errno));
  }
  file.read(&text[0], static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  const std::string problem = text.empty()              ? "it is empty"
                              : text.size() > kMaxBytes ? "it is too long"
                              : !isText(text)           ? "it is no text"
                                                        : "";
  if (!problem.empty()) throwUnusable(path, "", problem);
  return text;
}

CalibrationInFile parsed(const std::string& text, std::optional<CalibrationFormat> format,
                         const std::string& wanted) {
  if (!format) format = detectCalibrationFormat(text);
  if (!format) {
    throw std::runtime_error("it is none of the formats " + calibrationFormatNames());
  }
  return {parseCalibration(text, *format, wanted), *format};
}

/// The text with a comment where the format allows the first one.
std::string noted(const std::string& text, const std::string& note) {
  const std::string line = "# " + note + "\n";
  const std::string separator = "---\n";
  const std::size_t header = text.compare(0, 5, "%YAML") == 0 ? text.find(separator) : 0;
  if (header == 0 || header == std::string::npos) return line + text;
  return std::string(text).insert(header + separator.size(), line);
}

void checkReadBack(const std::string& text, CalibrationFormat format, const Camera& camera) {
  const Camera read = parseCalibration(text, format).camera;
  if (pixelDistance(camera, read).max < 1e-6) return;
  throw std::runtime_error("the calibration does not read back as it was written");
}

void replaceFile(const std::string& path, const std::string& text) {
  const std::string temporary = path + ".part";
  std::ofstream file(temporary, std::ios::binary);
  file << text;
  file.close();
  if (file && std::rename(temporary.c_str(), path.c_str()) == 0) return;
  const std::string why = std::strerror(errno);
  std::remove(temporary.c_str());
  throw std::runtime_error("the calibration cannot be written to " + path + ": " + why);
}

}  // namespace

CalibrationInFile readCalibration(const std::string& path, std::optional<CalibrationFormat> format,
                                  const std::string& wanted) {
  const std::string text = contents(path);
  try {
    return parsed(text, format, wanted);
  } catch (const std::exception& e) {
    throwUnusable(path, format ? " as " + toString(*format) : "", e.what());
  }
}

Rig readRigCalibration(const std::string& path) {
  const std::string text = contents(path);
  try {
    return parseRigCalibration(text);
  } catch (const std::exception& e) {
    throwUnusable(path, " for a rig", e.what());
  }
}

Camera readCalibrationFile(const std::string& path) {
  return readCalibration(path, std::nullopt, {}).stored.camera;
}

CameraFit writeCalibration(const std::string& path, const Camera& camera, CalibrationFormat format,
                           const CalibrationLabels& labels) {
  const CameraFit fit = storable(camera, format);
  std::string text = calibrationText(fit.camera, format, labels);
  const std::string note = fitNote(camera, fit.error);
  if (!note.empty()) text = noted(text, note);
  if (!labels.comment.empty()) text = noted(text, labels.comment);
  checkReadBack(text, format, fit.camera);
  replaceFile(path, text);
  return fit;
}

}  // namespace camera_self_calibration
