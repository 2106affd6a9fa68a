#pragma once

#include <gtest/gtest.h>
#include <ros/service.h>
#include <std_srvs/Trigger.h>

#include <string>

namespace camera_self_calibration {

/// What a service says.
struct Answer {
  bool success = false;
  std::string message;
};

inline Answer trigger(const std::string& service) {
  std_srvs::Trigger call;
  if (!ros::service::call(service, call)) return {false, "the call failed"};
  return {static_cast<bool>(call.response.success), call.response.message};
}

inline void expectSays(const Answer& answer, bool success, const std::string& word) {
  EXPECT_EQ(answer.success, success) << answer.message;
  EXPECT_NE(answer.message.find(word), std::string::npos) << answer.message;
}

}  // namespace camera_self_calibration
