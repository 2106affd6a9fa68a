#pragma once

#include <camera_self_calibration/Calibration.h>
#include <camera_self_calibration/CalibrationEvent.h>
#include <camera_self_calibration/TrackingStatus.h>
#include <nodelet/NodeletLoad.h>
#include <nodelet/NodeletUnload.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>

#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "camera_self_calibration/ros/stamps.h"
#include "camera_self_calibration/simulation/simulated_sequence.h"
#include "ros/recorder.h"

namespace camera_self_calibration {

/// Loads and unloads the nodelet in the manager /manager.
inline bool loadNodelet(const std::string& name, const std::string& image_topic) {
  nodelet::NodeletLoad load;
  load.request.name = name;
  load.request.type = "camera_self_calibration/SelfCalibrationNodelet";
  load.request.remap_source_args = {"image"};
  load.request.remap_target_args = {image_topic};
  return ros::service::call("/manager/load_nodelet", load) && load.response.success;
}

inline bool unloadNodelet(const std::string& name) {
  nodelet::NodeletUnload unload;
  unload.request.name = name;
  return ros::service::call("/manager/unload_nodelet", unload) && unload.response.success;
}

inline sensor_msgs::Image toMessage(const ImageView& view) {
  sensor_msgs::Image image;
  image.header.stamp = toRosTime(view.stamp_ns);
  image.header.frame_id = "camera_optical";
  image.encoding = sensor_msgs::image_encodings::MONO8;
  image.width = static_cast<std::uint32_t>(view.width);
  image.height = static_cast<std::uint32_t>(view.height);
  image.step = image.width;
  image.data.resize(image.step * image.height);
  for (int y = 0; y < view.height; ++y) {
    std::memcpy(&image.data[static_cast<std::size_t>(y) * image.step],
                view.data + static_cast<std::ptrdiff_t>(y) * view.stride, image.step);
  }
  return image;
}

/// A camera that moves through a rendered room, and the nodelet `name` that listens to it. Images
/// come one by one, each when the one before is done with.
class Robot {
 public:
  Robot(const Camera& lens, std::uint64_t seed, double start_s,
        const std::string& name = "/selfcal", const std::string& topic = "/camera/image_raw")
      : sequence_(optionsOf(lens, seed, start_s)),
        publisher_(ros::NodeHandle().advertise<sensor_msgs::Image>(topic, 5)),
        status(name + "/tracking_status"),
        calibration(name + "/calibration"),
        event(name + "/event"),
        camera_info(name + "/camera_info") {}

  bool connected() {
    return spinUntil(
        [this] {
          return publisher_.getNumSubscribers() > 0 && status.connected() &&
                 calibration.connected() && event.connected() && camera_info.connected();
        },
        20.0);
  }

  /// Publishes the next image and waits for its results.
  bool step() {
    const SimulatedFrame frame = sequence_.frame(next_++);
    publisher_.publish(toMessage(frame.view()));
    return spinUntil(
        [&] {
          return !status.messages.empty() &&
                 status.messages.back()->header.stamp == toRosTime(frame.stamp_ns);
        },
        10.0);
  }
  /// False if it takes more images.
  bool stepUntil(const std::function<bool()>& condition, int images) {
    for (int i = 0; i < images && next_ < sequence_.size(); ++i) {
      if (condition()) return true;
      if (!step()) return false;
    }
    return spinUntil(condition, 2.0);
  }
  bool converged() const {
    return !calibration.messages.empty() &&
           calibration.messages.back()->calibration_state == Calibration::CONVERGED;
  }
  /// Null if there was none.
  CalibrationEvent::ConstPtr eventOf(const std::string& type) const {
    for (const auto& message : event.messages) {
      if (message->type == type) return message;
    }
    return nullptr;
  }

 private:
  static SequenceOptions optionsOf(const Camera& lens, std::uint64_t seed, double start_s) {
    SequenceOptions options;
    options.lens.camera = lens;
    options.room.texture_detail = 0.3;
    options.rate_hz = 12.0;
    options.duration_s = 60.0;
    options.motion.speed = 0.6;
    options.motion.seed = seed;
    options.start_stamp_ns = static_cast<std::int64_t>(1e9 * start_s);
    return options;
  }

  SimulatedSequence sequence_;
  int next_ = 0;
  ros::Publisher publisher_;

 public:
  Recorder<TrackingStatus> status;
  Recorder<Calibration> calibration;
  Recorder<CalibrationEvent> event;
  Recorder<sensor_msgs::CameraInfo> camera_info;
};

}  // namespace camera_self_calibration
