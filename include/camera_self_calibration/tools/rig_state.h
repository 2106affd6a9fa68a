#pragma once

#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/rig/rig_estimate.h"

namespace camera_self_calibration {

/// What was learnt of a rig, for the next start: a converged estimate without the keyframes that it
/// rests on.
struct RigState {
  std::vector<std::string> cameras;  ///< Their names.
  RigEstimate estimate;              ///< Usable and converged; of `poses` the newest, no evidence.
};

/// JSON, with all digits.
std::string encode(const RigState& state);

/// Either a state or, in words, why there is none.
struct DecodedRigState {
  std::optional<RigState> state;
  std::string error;  ///< Empty if there is a state.
};

/// Foreign, damaged or cut off, or values that no rig has: an error, never a crash.
DecodedRigState decodeRigState(const std::string& text);

}  // namespace camera_self_calibration
