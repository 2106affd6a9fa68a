#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/pipeline/bag_record.h"
#include "camera_self_calibration/pipeline/health.h"
#include "camera_self_calibration/queue/candidate_window.h"

namespace camera_self_calibration {

/// All that was learnt of a camera, so that the next start need not learn it again: the queue's
/// segments and the estimate that rests on them.
struct LearntState {
  Camera camera;
  CalibrationState state = CalibrationState::kWaitingForMotion;
  std::int64_t stamp_ns = 0;  ///< Of the newest image that it rests on.
  std::int64_t keyframes = 0;
  std::uint64_t revision = 0;
  std::uint64_t epoch = 0;
  double line_delay_s = 0.0;        ///< Of a rolling shutter, that the segments are freed of [s].
  double line_delay_sigma_s = 0.0;  ///< Of its estimate; 0: none was made [s].
  std::vector<Candidate> segments;  ///< Of the queue, solved.
  /// The bags that it was learnt from, one lens or several; empty where it was learnt live.
  std::vector<BagRecord> bags;

  /// Every reason why it cannot be used, in words; empty if it can.
  std::vector<std::string> problems() const;
};

}  // namespace camera_self_calibration
