#include "camera_self_calibration/queue/score_kind.h"

namespace camera_self_calibration {

std::string toString(ScoreKind kind) { return kind == ScoreKind::kPixel ? "pixel" : "entropy"; }

std::optional<ScoreKind> scoreKindFromString(const std::string& name) {
  for (const ScoreKind kind : {ScoreKind::kEntropy, ScoreKind::kPixel}) {
    if (toString(kind) == name) return kind;
  }
  return std::nullopt;
}

}  // namespace camera_self_calibration
