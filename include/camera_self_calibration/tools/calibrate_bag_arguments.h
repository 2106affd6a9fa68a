#pragma once

#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/reference/trajectory_comparison.h"
#include "camera_self_calibration/tools/calibrate.h"
#include "camera_self_calibration/tools/calibrate_rig.h"
#include "camera_self_calibration/tools/image_source.h"

namespace camera_self_calibration {

/// The command line of calibrate_bag.
struct CalibrateBagArguments {
  SourceOptions source;
  Options options;
  std::string out;                  ///< Folder for the results; empty: none are written.
  std::string state_out;            ///< File for what was learnt; empty: none is written.
  std::string camera;               ///< Name of the camera in it; empty: the topic, folder or file.
  bool overwrite = false;           ///< `state_out`, whatever it holds.
  std::vector<std::string> topics;  ///< Of a rig: one for each camera; empty: there is one camera.
  RigExtras rig;                    ///< Of a rig, but for `stop`.
  CalibrateExtras extras;
  std::vector<StampedCameraPose> ground_truth;  ///< Empty: none was given.
  bool report = false;                          ///< report.html goes into the folder.
  std::string given;  ///< The options that bear on the result, as they were given.
};

/// Nothing if only help was asked for, which is printed. Throws std::runtime_error on wrong
/// arguments, listing every problem of the options at once.
std::optional<CalibrateBagArguments> parseCalibrateBagArguments(int argc, const char* const* argv);

}  // namespace camera_self_calibration
