#include "camera_self_calibration/ros/frame_names.h"

#include <algorithm>

namespace camera_self_calibration {

std::string withoutSlash(const std::string& frame) {
  return frame.substr(std::min(frame.find_first_not_of('/'), frame.size()));
}

std::string FrameNames::camera() const {
  const std::string name = withoutSlash(child.empty() ? image_frame : child);
  return name.empty() ? "camera" : name;
}

std::string FrameNames::problem() const {
  if (camera() != withoutSlash(world)) return {};
  return "the camera's frame and world_frame have the same name '" + camera() +
         "', so that no transform can be published; set world_frame or child_frame.";
}

}  // namespace camera_self_calibration
