#pragma once

#include <functional>
#include <optional>
#include <string>

#include "camera_self_calibration/audit/audit.h"
#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/tools/image_source.h"
#include "camera_self_calibration/tools/recording.h"

namespace camera_self_calibration {

/// What to do beside the calibration itself, on the same images.
struct CalibrateExtras {
  std::optional<Camera> reference;  ///< Held in a second run, whose poses are recorded.
  std::optional<Camera> audited;    ///< Held against what the video says; of any image size.
  AuditOptions audit;
  bool example = false;  ///< Keep an image with its tracks.
  bool batch = false;    ///< Whole-trajectory batch at intervals, queues of other sizes.
  /// Asked before each image; the run ends where it says true. May be empty.
  std::function<bool()> stop;
};

/// A report as the verdict on a whole recording: CONVERGED only if it isGoodNow(), else as judged
/// afresh.
CalibrationReport atTheEnd(CalibrationReport report);

/// Runs the inline pipeline over a sequence, with progress on a terminal. Images that
/// InputMonitor rejects are left out with a warning on standard error. Throws std::runtime_error if
/// images are there and none can be used, or the start values are for another image size, and
/// std::invalid_argument on bad options. A run that was stopped has no batch. Its final_report is
/// atTheEnd().
Recording calibrate(ImageSource* source, const Options& options,
                    const CalibrateExtras& extras = {});

}  // namespace camera_self_calibration
