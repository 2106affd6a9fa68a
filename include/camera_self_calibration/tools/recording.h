#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "camera_self_calibration/audit/audit.h"
#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/reference/trajectory_comparison.h"
#include "camera_self_calibration/tools/batch_comparison.h"
#include "camera_self_calibration/tools/example_image.h"
#include "camera_self_calibration/tools/json.h"

namespace camera_self_calibration {

/// A pose of the trajectory.
struct TimedPose : StampedCameraPose {
  bool is_keyframe = false;
};

/// Stands in every result of a run that was stopped.
constexpr const char* kPartial = "PARTIAL: the run was interrupted before the last image.";

/// What a run over stored images leaves behind.
struct Recording {
  bool complete = true;        ///< False: stopped before the last image.
  std::int64_t frames = 0;     ///< Images processed.
  std::int64_t keyframes = 0;  ///< Among them.
  std::int64_t carried = 0;    ///< Features that were left out, see CarriedFeatures.
  std::int64_t begin_ns = 0;   ///< First and last of them.
  std::int64_t end_ns = 0;
  double processing_seconds = 0.0;         ///< Wall time of the run, reading included [s].
  std::vector<TimedPose> poses;            ///< Of the images that were tracked.
  std::vector<CalibrationReport> reports;  ///< One for each keyframe, as it was at that time.
  std::vector<Event> events;
  CalibrationReport final_report;  ///< The verdict after the last image (atTheEnd()).
  /// The queue at the end, which the final report rests on; null before hand-over.
  std::shared_ptr<const LearntState> learnt;

  std::optional<ExampleImage> example;  ///< If asked for.

  std::optional<Camera> audited;     ///< A calibration in question, if given,
  std::optional<AuditReport> audit;  ///< and what the video says of it at the end.

  std::optional<Camera> reference;         ///< A calibration to compare with, if given.
  std::vector<TimedPose> reference_poses;  ///< Of a second run that held it.
  BatchComparison batch;                   ///< Empty if not asked for.
};

/// TUM format, world_from_camera. The poses of different maps do not belong together, which a
/// comment line tells. `unit` is that of the positions, in words.
void writeTrajectory(const std::vector<TimedPose>& poses, bool complete, const std::string& unit,
                     std::ostream& file);

/// summary.json, the same for the same input but for the time that the run took,
/// `processing_seconds` and `frames_per_second`. What is not known is null. `extra` members come
/// last.
Json summaryJson(const Recording& recording, const Json& extra = Json::object());

/// Writes the files of calibrate_bag into an existing folder: summary.json (with the `extra`
/// members), trajectory.tum, keyframes.tum, convergence.csv, and, if CONVERGED,
/// calibration.yaml and camchain.yaml. Removes those of an earlier run first. Returns what is
/// to be said of them, one sentence each: which one holds an approximation, and how good it is.
/// Those of a run that is not complete say so. Throws std::runtime_error if a file cannot be
/// written.
std::vector<std::string> writeRecording(const std::string& folder, const std::string& topic,
                                        const Recording& recording,
                                        const Json& extra = Json::object());

}  // namespace camera_self_calibration
