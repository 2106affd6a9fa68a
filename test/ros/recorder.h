#pragma once

#include <ros/init.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>

#include <functional>
#include <string>
#include <vector>

#include "sanitized.h"

namespace camera_self_calibration {

/// All messages of a topic.
template <typename Message>
class Recorder {
 public:
  Recorder(const std::string& topic, ros::NodeHandle node = {}) {
    subscriber_ = node.subscribe<Message>(
        topic, 1000,
        [this](const typename Message::ConstPtr& message) { messages.push_back(message); });
  }

  bool connected() const { return subscriber_.getNumPublishers() > 0; }

  std::vector<typename Message::ConstPtr> messages;

 private:
  ros::Subscriber subscriber_;
};

/// Works off callbacks until the condition holds; false if that takes longer than the limit (ten
/// times as long under a sanitizer).
inline bool spinUntil(const std::function<bool()>& condition, double limit_s) {
  const double patience_s = kSanitized ? 10.0 * limit_s : limit_s;
  const ros::WallTime limit = ros::WallTime::now() + ros::WallDuration(patience_s);
  while (ros::ok() && !condition()) {
    if (ros::WallTime::now() > limit) return false;
    ros::spinOnce();
    ros::WallDuration(0.005).sleep();
  }
  return condition();
}

}  // namespace camera_self_calibration
