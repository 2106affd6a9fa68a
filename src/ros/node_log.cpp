#include "camera_self_calibration/ros/node_log.h"

#include <ros/console.h>

#include "camera_self_calibration/base/formatted.h"

namespace camera_self_calibration {
namespace {

constexpr double kThrottle = 5.0;  // [s]

}  // namespace

void NodeLog::info(const std::string& text) const { ROS_INFO_STREAM(node_ << ": " << text); }

void NodeLog::warn(const std::string& text) const { ROS_WARN_STREAM(node_ << ": " << text); }

void NodeLog::warnThrottled(const std::string& text) {
  const ros::WallTime now = ros::WallTime::now();
  if (!last_warning_.isZero() && now - last_warning_ < ros::WallDuration(kThrottle)) return;
  last_warning_ = now;
  warn(text);
}

void NodeLog::idle(const std::vector<std::string>& problems) const {
  std::string text;
  for (const std::string& problem : problems) text += "\n  - " + withFullStop(problem);
  ROS_ERROR_STREAM(node_ << ": idle, since the parameters cannot be used:" << text);
}

// The problems keep their small letters: they begin with the name of a parameter.
std::string idleSentence(const std::vector<std::string>& problems) {
  std::string text;
  for (const std::string& problem : problems) text += " " + withFullStop(problem);
  return text.empty() ? "" : "Idle, the parameters cannot be used:" + text;
}

}  // namespace camera_self_calibration
