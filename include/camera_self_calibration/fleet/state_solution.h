#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/pipeline/shutter.h"
#include "camera_self_calibration/queue/segment_queue.h"

namespace camera_self_calibration {

/// The segments of a state, solved together again, with the rolling shutter that they show.
struct StateSolution {
  SegmentQueue queue;  ///< solution() is not usable where there is none.
  double line_delay_s = 0.0;
  double line_delay_sigma_s = 0.0;
};

/// As a robot that starts with the state would solve it, of all its segments, in this order. The
/// line delay is estimated anew from them, unless none of the runs did.
StateSolution solveState(const LearntState& state, int threads = 1);

/// The segments evaluated anew with the model of `lens`, from there on; the estimate is theirs
/// together. Null where that has no solution.
std::shared_ptr<const LearntState> withModel(const LearntState& state, const Camera& lens);

/// What a state says of its camera, from its segments alone; the text members but for the version
/// are left empty. Nothing where they have no solution.
std::optional<BagRecord> recordOf(const LearntState& state);

/// "0.1.0".
std::string programVersion();

}  // namespace camera_self_calibration
