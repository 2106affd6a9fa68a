#pragma once

#include <memory>
#include <string>

namespace camera_self_calibration {

struct LearntState;  // pipeline/learnt_state.h

/// A versioned binary text with a checksum, the same on every machine.
std::string encode(const LearntState& state);

/// Either a state or, in words, why there is none.
struct DecodedState {
  std::shared_ptr<const LearntState> state;
  std::string error;  ///< Empty if there is a state.
};

/// Whether these are the first bytes of a state file, be the rest damaged or not.
bool beginsAsState(const std::string& bytes);

/// Foreign, damaged, cut off or from a newer version: an error, never a crash or a wrong state.
DecodedState decodeState(const std::string& bytes);

/// decodeState() of a file.
DecodedState readStateFile(const std::string& path);

}  // namespace camera_self_calibration
