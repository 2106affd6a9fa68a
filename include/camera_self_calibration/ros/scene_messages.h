#pragma once

#include <sensor_msgs/PointCloud2.h>
#include <visualization_msgs/MarkerArray.h>

#include <string>

#include "camera_self_calibration/ros/scene.h"

namespace camera_self_calibration {

/// The scene as markers of rviz, each namespace one marker that replaces the one before:
///  - trajectory: line through the keyframes
///  - keyframes:  a dot for each
///  - window:     a small camera for each keyframe of the sliding window
///  - queue:      the segments that the calibration rests on, thick, coloured by score
///  - frustum:    the estimated field of view at the camera's pose, in the colour of the state
///  - view:       its faces, translucent
///  - events:     what happened in this map, in words where it happened (Scene::kMaxEvents markers)
visualization_msgs::MarkerArray toMarkers(const Scene& scene, const std::string& world_frame,
                                          const ros::Time& stamp);

/// The landmarks with the fields x y z [map units] and rgb, a warm gray as bright as in the image.
sensor_msgs::PointCloud2 toCloud(const Scene& scene, const std::string& world_frame,
                                 const ros::Time& stamp);

}  // namespace camera_self_calibration
