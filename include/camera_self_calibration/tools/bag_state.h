#pragma once

#include <memory>
#include <string>

#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/tools/recording.h"

namespace camera_self_calibration {

/// What a complete run learnt, with the record of its bag; null where the segments of the video
/// never were enough for an estimate of their own.
std::shared_ptr<const LearntState> stateOfBag(const Recording& recording, const std::string& bag,
                                              const std::string& camera);

/// Throws std::runtime_error if `path` is a file, but no state file, whole or damaged: what
/// somebody else has written is never replaced.
void refuseForeignFile(const std::string& path);

/// The state in `path` if it is the result of `bag` for `camera`; null if there is no such file.
/// Throws std::runtime_error if it is something else, which must not be written over.
std::shared_ptr<const LearntState> finishedState(const std::string& path, const std::string& bag,
                                                 const std::string& camera);

/// Throws std::runtime_error if it cannot be written.
void writeState(const std::string& path, const LearntState& state);

}  // namespace camera_self_calibration
