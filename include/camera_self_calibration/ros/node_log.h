#pragma once

#include <ros/time.h>

#include <string>
#include <utility>
#include <vector>

namespace camera_self_calibration {

/// What a node says in the log of ROS; each line begins with the node's name.
class NodeLog {
 public:
  explicit NodeLog(std::string node) : node_(std::move(node)) {}

  void info(const std::string& text) const;
  void warn(const std::string& text) const;

  /// At most once in five seconds, since images come faster than anybody reads.
  void warnThrottled(const std::string& text);

  /// That the node does nothing since its parameters cannot be used: what is wrong, line by line.
  void idle(const std::vector<std::string>& problems) const;

 private:
  std::string node_;
  ros::WallTime last_warning_;
};

/// The same for /diagnostics; empty if there are no problems.
std::string idleSentence(const std::vector<std::string>& problems);

}  // namespace camera_self_calibration
