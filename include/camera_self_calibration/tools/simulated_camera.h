#pragma once

#include <camera_self_calibration/TrackingStatus.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>

#include <memory>
#include <vector>

#include "camera_self_calibration/simulation/simulated_sequence.h"
#include "camera_self_calibration/tools/simulation_options.h"

namespace camera_self_calibration {

/// Publishes a simulated sequence as an ordinary camera: image_raw and an uncalibrated camera_info.
/// The truth goes to topics of its own: truth/camera_info, truth/calibration (latched) and
/// truth/pose; truth/finished (latched, stamp of the last image) marks the end.
class SimulatedCamera {
 public:
  /// Throws std::invalid_argument if the options are out of range.
  /// Works off the global callback queue while it waits.
  SimulatedCamera(const ros::NodeHandle& node, const SimulationOptions& options);

  int size() const { return sequence_.size(); }
  double rate() const { return options_.sequence.rate_hz; }  ///< [Hz]

  /// With wait_for: until somebody listens. False if ROS shuts down.
  bool waitForSubscribers();

  SimulatedFrame frame(int index) const { return sequence_.frame(index); }

  /// Publishes an image, and with wait_for waits until it is done with. The latched truth lives as
  /// long as this object.
  void publish(const SimulatedFrame& frame);

  /// Tells that there are no more.
  void finish();

 private:
  void publishTruth(const SimulatedFrame& frame);
  void publishFrame(const SimulatedFrame& frame);
  void publishClock(std::int64_t stamp_ns);
  void publishFinished(std::int64_t stamp_ns);
  void waitUntilProcessed(const ros::Time& stamp);

  const SimulationOptions options_;
  SimulatedSequence sequence_;
  ros::NodeHandle node_;
  ros::Publisher image_;
  ros::Publisher camera_info_;
  ros::Publisher clock_;
  ros::Publisher true_camera_info_;
  ros::Publisher true_calibration_;
  ros::Publisher true_pose_;
  ros::Publisher finished_;
  ros::Subscriber status_;
  ros::Time processed_;
};

/// Publishes all images of cameras that are taken at once, at their rate or as fast as the consumer
/// follows; returns early if ROS shuts down.
void run(std::vector<std::unique_ptr<SimulatedCamera>>* cameras);

}  // namespace camera_self_calibration
