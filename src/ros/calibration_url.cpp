#include "camera_self_calibration/ros/calibration_url.h"

#include <ros/package.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace camera_self_calibration {
namespace {

const std::string kDefaultUrl = "file://${ROS_HOME}/camera_info/${NAME}.yaml";
const std::string kFile = "file://";
const std::string kPackage = "package://";

bool isNameCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

bool startsWith(const std::string& text, const std::string& prefix) {
  return text.size() >= prefix.size() &&
         std::equal(prefix.begin(), prefix.end(), text.begin(), [](char a, char b) {
           return std::tolower(static_cast<unsigned char>(a)) ==
                  std::tolower(static_cast<unsigned char>(b));
         });
}

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

std::string rosHome() {
  const std::string home = environment("ROS_HOME");
  return home.empty() ? environment("HOME") + "/.ros" : home;
}

/// Replaces ${NAME} and ${ROS_HOME}; any other ${...} is an error.
ResolvedPath substitute(const std::string& text, const std::string& camera_name) {
  ResolvedPath result;
  std::size_t position = 0;
  while (position < text.size()) {
    const std::size_t begin = text.find("${", position);
    result.path += text.substr(position, begin - position);
    if (begin == std::string::npos) break;
    const std::size_t end = text.find('}', begin);
    if (end == std::string::npos) return {"", "'" + text + "' has a ${ without a }"};
    const std::string name = text.substr(begin + 2, end - begin - 2);
    if (name != "NAME" && name != "ROS_HOME") {
      return {"", "'" + text + "' uses ${" + name + "}; only ${NAME} and ${ROS_HOME} are known"};
    }
    result.path += name == "NAME" ? camera_name : rosHome();
    position = end + 1;
  }
  return result;
}

ResolvedPath inPackage(const std::string& url) {
  const std::string rest = url.substr(kPackage.size());
  const std::size_t slash = rest.find('/');
  if (slash == 0 || slash == std::string::npos || slash + 1 == rest.size()) {
    return {"", "'" + url + "' must be package://PACKAGE/PATH"};
  }
  const std::string folder = ros::package::getPath(rest.substr(0, slash));
  if (folder.empty()) return {"", "the package " + rest.substr(0, slash) + " is not known"};
  return {folder + rest.substr(slash), ""};
}

ResolvedPath fromUrl(const std::string& url) {
  if (startsWith(url, kPackage)) return inPackage(url);
  if (startsWith(url, kFile + "/") && url.size() > kFile.size() + 1) {
    return {url.substr(kFile.size()), ""};
  }
  return {"", "'" + url + "' must be file:///PATH or package://PACKAGE/PATH"};
}

}  // namespace

ResolvedPath resolveCalibrationUrl(const std::string& url, const std::string& camera_name) {
  const ResolvedPath substituted = substitute(url.empty() ? kDefaultUrl : url, camera_name);
  return substituted.error.empty() ? fromUrl(substituted.path) : substituted;
}

ResolvedPath resolvePath(const std::string& path_or_url, const std::string& camera_name) {
  ResolvedPath result = substitute(path_or_url, camera_name);
  std::string& path = result.path;
  if (path.empty()) return result;
  if (path.find("://") != std::string::npos) return fromUrl(path);
  if (path.compare(0, 2, "~/") == 0) path = environment("HOME") + path.substr(1);
  if (path.front() != '/') path = rosHome() + "/" + path;
  return result;
}

bool isCameraName(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), isNameCharacter);
}

std::string toCameraName(const std::string& name) {
  std::string result;
  for (const char c : name) {
    if (result.empty() && !isNameCharacter(c)) continue;
    result += isNameCharacter(c) ? c : '_';
  }
  return result.empty() ? "camera" : result;
}

}  // namespace camera_self_calibration
