#pragma once

#include <optional>
#include <string>

namespace camera_self_calibration {

/// What makes one segment better than another.
enum class ScoreKind {
  kEntropy,  ///< Normalised differential entropy (D-optimality), as in the paper.
  kPixel     ///< Expected pixel error over the image, rms (I-optimality).
};

/// "entropy", "pixel".
std::string toString(ScoreKind kind);
/// Nothing for any other string.
std::optional<ScoreKind> scoreKindFromString(const std::string& name);

}  // namespace camera_self_calibration
