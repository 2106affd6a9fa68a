#pragma once

#include <string>

namespace camera_self_calibration {

/// A file name, or in words why there is none.
struct ResolvedPath {
  std::string path;
  std::string error;  ///< Empty if there is a path.
};

/// The file behind a calibration URL, by the rules of camera_info_manager: file:///PATH or
/// package://PACKAGE/PATH, in which ${NAME} stands for the camera's name and ${ROS_HOME} for that
/// folder (else ~/.ros). An empty URL is file://${ROS_HOME}/camera_info/${NAME}.yaml. What
/// camera_info_manager leaves unresolved with a log line is an error here.
ResolvedPath resolveCalibrationUrl(const std::string& url, const std::string& camera_name);

/// The same for any file; a plain path is allowed too (a leading ~/ is the home folder), relative
/// ones start at ${ROS_HOME}. Empty stays empty, without an error.
ResolvedPath resolvePath(const std::string& path_or_url, const std::string& camera_name);

/// Letters, digits and underscores, not empty, as camera_info_manager wants it.
bool isCameraName(const std::string& name);

/// The name with everything else replaced by underscores: "/left/selfcal" gives "left_selfcal".
std::string toCameraName(const std::string& name);

}  // namespace camera_self_calibration
