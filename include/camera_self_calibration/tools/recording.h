#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "camera_self_calibration/pipeline/results.h"

namespace camera_self_calibration {

/// A pose of the trajectory.
struct TimedPose {
  std::int64_t stamp_ns = 0;
  std::uint64_t map_id = 0;
  bool is_keyframe = false;
  Rigid3 world_from_camera;
};

/// What a run over stored images leaves behind.
struct Recording {
  std::int64_t frames = 0;                 ///< Images processed.
  std::int64_t keyframes = 0;              ///< Among them.
  double processing_seconds = 0.0;         ///< Wall time of the run, reading included [s].
  std::vector<TimedPose> poses;            ///< Of the images that were tracked.
  std::vector<CalibrationReport> reports;  ///< One for each keyframe.
  std::vector<Event> events;
  CalibrationReport final_report;  ///< After the last image.
};

/// The text of summary.json.
std::string summaryJson(const Recording& recording);

/// Writes the files of calibrate_bag into an existing folder: summary.json, trajectory.tum,
/// keyframes.tum, convergence.csv, and, if CONVERGED, calibration.yaml and camchain.yaml (those of
/// an earlier run are removed if not). Throws std::runtime_error if a file cannot be written.
void writeRecording(const std::string& folder, const std::string& topic,
                    const Recording& recording);

}  // namespace camera_self_calibration
