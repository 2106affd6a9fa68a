#pragma once

#include <string>
#include <vector>

#include "camera_self_calibration/ros/node_options.h"

namespace camera_self_calibration {

/// The camera's name, or else one made from the node's.
std::string cameraName(const NodeOptions& options, const std::string& node_name);

/// Every violated rule of the parameters of files, in one sentence each.
std::vector<std::string> keepingProblems(const NodeOptions& options);

/// Every two of the files that are one and the same, in one sentence each. `name` is the node's,
/// which stands for ${NAME} where the camera has no name of its own.
std::vector<std::string> sameFileProblems(const NodeOptions& options, const std::string& name);

}  // namespace camera_self_calibration
