#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/rig/mount_change.h"
#include "camera_self_calibration/rig/rig_audit.h"
#include "camera_self_calibration/rig/rig_estimate.h"
#include "camera_self_calibration/tools/calibrate.h"
#include "camera_self_calibration/tools/recording.h"

namespace camera_self_calibration {

/// What a run over the images of several cameras leaves behind.
struct RigRecording {
  std::vector<std::string> topics;  ///< As found in the bag, one for each camera.
  std::vector<Recording> cameras;   ///< Each one's own run; with joint intrinsics, if CONVERGED.
  RigEstimate estimate;             ///< Not usable: its sentence says why.
  std::vector<MountChange> mount_changes;  ///< Cameras that were moved, in the order of time.
  std::vector<TimedPose> poses;            ///< Of the rig in each image; empty without an estimate.
  std::optional<Rig> audited;              ///< A calibration in question, if given,
  std::optional<RigAudit> audit;           ///< and what the video says of it.
  bool complete = true;                    ///< False: stopped before the last image.

  /// Whether each camera and the rig as a whole have converged.
  bool converged() const;
  /// INITIALIZING without an estimate, CONVERGING until converged().
  CalibrationState state() const;
};

/// What is known of a rig, and what to do beside its calibration.
struct RigExtras {
  std::optional<double> baseline_m;  ///< Between the first two cameras [m].
  std::optional<Rig> audited;        ///< Held against what the video says; as many cameras.
  AuditOptions audit;
  bool example = false;        ///< Keep an image of each camera with its tracks.
  std::function<bool()> stop;  ///< As CalibrateExtras::stop.
};

/// Calibrates the cameras of a bag one by one, as calibrate() does, then follows all of them
/// together with these intrinsics held, and solves for the rig. Throws as calibrate(), and where an
/// image topic is missing.
RigRecording calibrateRig(const SourceOptions& source, const std::vector<std::string>& topics,
                          const Options& options, const RigExtras& extras);

}  // namespace camera_self_calibration
