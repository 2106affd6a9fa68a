#pragma once

#include <ros/time.h>

#include <cstdint>

#include "camera_self_calibration/base/stamp.h"

namespace camera_self_calibration {

inline std::int64_t toNanoseconds(const ros::Time& time) {
  return static_cast<std::int64_t>(time.sec) * 1000000000 + time.nsec;
}

/// Negative times, which ROS does not have, become 0.
inline ros::Time toRosTime(std::int64_t nanoseconds) {
  if (nanoseconds < 0) return {};
  return {static_cast<std::uint32_t>(nanoseconds / 1000000000),
          static_cast<std::uint32_t>(nanoseconds % 1000000000)};
}

}  // namespace camera_self_calibration
