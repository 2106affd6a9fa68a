#include "camera_self_calibration/ros/file_parameters.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "camera_self_calibration/ros/calibration_url.h"

namespace camera_self_calibration {
namespace {

/// Whether two paths lead to one file, there or not, links followed.
bool areOneFile(const std::string& a, const std::string& b) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  const fs::path full_a = fs::weakly_canonical(a, error);
  const fs::path full_b = fs::weakly_canonical(b, error);
  return !error && full_a == full_b;
}

}  // namespace

std::string cameraName(const NodeOptions& options, const std::string& node_name) {
  return options.camera_name.empty() ? toCameraName(node_name) : options.camera_name;
}

std::vector<std::string> keepingProblems(const NodeOptions& options) {
  std::vector<std::string> problems;
  const std::string name = options.camera_name.empty() ? "camera" : options.camera_name;
  if (!isCameraName(name)) {
    problems.push_back("camera_name is '" + name +
                       "'; it may hold letters, digits and underscores only");
  }
  const auto check = [&problems](const char* parameter, const ResolvedPath& resolved) {
    if (!resolved.error.empty()) problems.push_back(std::string(parameter) + ": " + resolved.error);
  };
  check("camera_info_url", resolveCalibrationUrl(options.camera_info_url, name));
  const std::string& url = options.camera_info_url;
  if (url.size() > 4 && url.compare(url.size() - 4, 4, ".ini") == 0) {
    problems.push_back("camera_info_url names an .ini file; only .yaml files are written");
  }
  check("state_file", resolvePath(options.state_file, name));
  check("report_file", resolvePath(options.report_file, name));
  if (options.report_file.empty()) problems.push_back("report_file must not be empty");
  constexpr double kDay = 86400.0;  // [s]
  if (!(options.autosave_interval_s >= 0.0 && options.autosave_interval_s <= kDay)) {
    problems.push_back("autosave_interval_s must lie between 0, which turns it off, and 86400");
  }
  return problems;
}

std::vector<std::string> sameFileProblems(const NodeOptions& options, const std::string& name) {
  const std::string camera = cameraName(options, name);
  const std::string calibration = resolveCalibrationUrl(options.camera_info_url, camera).path;
  const std::string state = resolvePath(options.state_file, camera).path;
  const auto previous = [](const std::string& path) {
    return path.empty() ? path : path + ".previous";
  };
  const std::vector<std::pair<std::string, std::string>> files = {
      {"camera_info_url", calibration},
      {"camera_info_url with .previous", previous(calibration)},
      {"state_file", state},
      {"state_file with .previous", previous(state)},
      {"report_file", resolvePath(options.report_file, camera).path},
      {"mask_url", resolvePath(options.mask_url, camera).path}};
  std::vector<std::string> problems;
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t j = i + 1; j < files.size(); ++j) {
      const auto& [a, path_a] = files[i];
      const auto& [b, path_b] = files[j];
      if (path_a.empty() || path_b.empty() || !areOneFile(path_a, path_b)) continue;
      problems.push_back(a + " and " + b + " are the same file, " + path_b +
                         "; each needs a file of its own");
    }
  }
  return problems;
}

}  // namespace camera_self_calibration
