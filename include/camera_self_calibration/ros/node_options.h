#pragma once

#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/ros/parameter_reader.h"

namespace camera_self_calibration {

/// The parameters of the node; config/parameters.yaml explains each.
struct NodeOptions {
  Options pipeline;
  std::string model = "auto";     ///< Name of pipeline.model, or "auto": none is given.
  std::string score = "entropy";  ///< Name of pipeline.score.
  /// See setRollingShutter: pipeline.estimate_readout and readout_s.
  std::string rolling_shutter = "auto";
  /// Start values in the order of the model's parameters; empty: a guess from the image size.
  std::vector<double> initial_intrinsics;

  std::string image_transport = "auto";   ///< raw | compressed | auto.
  std::string mask_url;                   ///< Image, black where no feature may be; empty: none.
  std::string camera_info_input = "off";  ///< off | initial | compare.
  double factory_warn_px = 1.0;  ///< What a factory calibration may be off (AuditOptions) [px rms].
  std::string world_frame = "selfcal_map";  ///< Of poses; its origin and scale are arbitrary.
  std::string child_frame;                  ///< Empty: the frame_id of the images.
  bool publish_tf = true;
  bool invert_tf = false;              ///< The camera's frame is the parent.
  double min_publish_change_px = 0.1;  ///< A CameraInfo is replaced if it differs by more [px rms].
  bool publish_uncalibrated = false;   ///< Estimates before CONVERGED go out as CameraInfo too.
  /// auto | plumb_bob | rational_polynomial | equidistant.
  std::string output_distortion_model = "auto";
  std::string projection = "follow";  ///< P of the CameraInfo: follow | fixed.
  int path_poses = 1000;              ///< Of ~path, at most.

  std::string camera_name;      ///< In the calibration file; empty: the node's name.
  std::string camera_info_url;  ///< As for camera_info_manager; empty: nothing is read or saved.
  std::string state_file;       ///< Path or URL; empty: none.
  double autosave_interval_s = 30.0;                        ///< 0: only ~save saves.
  std::string report_file = "selfcal_report_${NAME}.yaml";  ///< Of ~dump_report; path or URL.
  std::string commit_service;  ///< Of the driver; empty: set_camera_info beside the images.

  /// Every violated bound in one sentence each, those of the pipeline included.
  std::vector<std::string> problems() const;
};

/// The parameters of the pipeline alone, with what their names stand for.
void readPipelineOptions(ParameterReader& read, NodeOptions* options);

using NodeOptionsReading = OptionsReading<NodeOptions>;

/// Reads the private parameters; what is absent keeps its default.
NodeOptionsReading readNodeOptions(const ros::NodeHandle& private_node);

}  // namespace camera_self_calibration
