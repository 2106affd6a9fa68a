#pragma once

#include <camera_self_calibration/Calibration.h>
#include <camera_self_calibration/CalibrationEvent.h>
#include <camera_self_calibration/Queue.h>
#include <camera_self_calibration/TrackingStatus.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/PoseWithCovariance.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/TwistWithCovariance.h>

#include "camera_self_calibration/pipeline/results.h"

namespace camera_self_calibration {

// The library's results as messages. Headers are left to the caller.

/// Standard deviations of all parameters: 0 for those held fixed, not a number while there is no
/// estimate.
std::vector<double> parameterSigmas(const CalibrationReport& report);

geometry_msgs::Pose toPose(const Rigid3& pose);

geometry_msgs::Transform toTransform(const Rigid3& pose);

/// `position` and `rotation`: covariances in the axes of the parent frame, which is the convention
/// of ROS.
geometry_msgs::PoseWithCovariance toPoseWithCovariance(const Rigid3& pose,
                                                       const Eigen::Matrix3d& position,
                                                       const Eigen::Matrix3d& rotation);

/// The covariance in the convention of ROS: both parts about the axes of the world frame.
geometry_msgs::PoseWithCovariance toPoseWithCovariance(const FrameResult& result);

/// Mean velocity between two images of one map, in the camera frame of the newer one [map unit/s,
/// rad/s]. The covariance takes the two poses for independent, which bounds it from above.
geometry_msgs::TwistWithCovariance toTwist(const FrameResult& before, const FrameResult& now);

TrackingStatus toTrackingStatus(const FrameResult& result, std::int64_t dropped_images);

Calibration toCalibration(const CalibrationReport& report, TrackingState tracking_state,
                          const std::string& tracking_sentence);

Queue toQueue(const QueueReport& report);

CalibrationEvent toCalibrationEvent(const Event& event, std::uint64_t epoch);

}  // namespace camera_self_calibration
