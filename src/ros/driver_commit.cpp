#include "camera_self_calibration/ros/driver_commit.h"

#include <ros/service.h>
#include <sensor_msgs/SetCameraInfo.h>

#include <chrono>
#include <future>
#include <sstream>

namespace camera_self_calibration {

CommitOutcome commitToDriver(const ros::NodeHandle& node, const std::string& service,
                             const sensor_msgs::CameraInfo& info, double timeout_s) {
  if (!ros::service::exists(service, false)) {
    return {false, "the camera's driver offers no service " + service +
                       "; is it running, and is ~commit_service right?"};
  }
  ros::NodeHandle handle(node);
  // Persistent, since only then can a call that is not answered be ended from outside.
  ros::ServiceClient client =
      handle.serviceClient<sensor_msgs::SetCameraInfo>(service, /*persistent=*/true);
  sensor_msgs::SetCameraInfo call;
  call.request.camera_info = info;
  std::future<bool> answered =
      std::async(std::launch::async, [&client, &call] { return client.call(call); });
  const auto limit = std::chrono::duration<double>(timeout_s);
  if (answered.wait_for(limit) != std::future_status::ready) {
    client.shutdown();
    answered.wait();
    std::ostringstream text;
    text << "the driver's service " << service << " did not answer within " << timeout_s << " s";
    return {false, text.str()};
  }
  if (!answered.get()) return {false, "the call of the driver's service " + service + " failed"};
  const auto& response = call.response;
  const std::string words = response.status_message.empty() ? "" : ": " + response.status_message;
  if (!response.success) return {false, "the driver refused the calibration" + words};
  return {true, "the driver accepted the calibration" + words};
}

std::string driverService(const std::string& image_topic) {
  const std::size_t slash = image_topic.rfind('/');
  const std::string space = slash == std::string::npos ? "" : image_topic.substr(0, slash);
  return space + "/set_camera_info";
}

}  // namespace camera_self_calibration
