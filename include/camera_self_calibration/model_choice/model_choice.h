#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/image_field.h"
#include "camera_self_calibration/model_choice/lens_trial.h"
#include "camera_self_calibration/model_choice/model_report.h"

namespace camera_self_calibration {

/// exp(nats), for people: how many times as likely something is; "0.14", "12", "10^17", "more than
/// 10^20".
std::string timesAsLikely(double nats);

struct ModelChoiceOptions {
  /// Probability by chance of so much a worse fit, below which a model is refuted: a richer one may
  /// take over then. One that is too rich costs little and says what it costs, one that is too
  /// simple is wrong and does not: this is less strict than LensFitOptions::significance.
  double refuted = 0.01;
  /// Above which nothing speaks against a model: a simpler one takes over then, if it is expected
  /// to be nearer to the truth. Between both, what is in use stays.
  double plausible = 0.1;
  /// A simpler model takes over in any case where its expected squared error is less than this
  /// share of that of the one in use.
  double clearly_less = 0.5;
};

/// Which projection model the lens follows: the simplest that the observations do not refute
/// (likelihood ratio), as soon as it is known well enough to be nearer to the truth than the one in
/// use. A simpler one takes over again where nothing speaks against it, or where the one in use has
/// parameters that the motion does not determine; one that segments of video have refuted only
/// then.
class ModelChoice {
 public:
  explicit ModelChoice(const ModelChoiceOptions& options) : options_(options) {}

  /// Whether there are enough keyframes more than at the last comparison that asked (a quarter, at
  /// least 5, at most 100): the effort per keyframe stays bounded.
  bool isDue(std::int64_t keyframes);

  /// The lens to go on with, if it should be another than the one in use. Fits the models that the
  /// comparison left open, as few as need be.
  std::optional<LensTrial> choose(const LensComparison& comparison, const ImageField& field,
                                  int threads);

  /// The newest comparison, one entry a model that was fitted; empty before the first.
  const std::vector<ModelEvidence>& evidence() const { return evidence_; }

  /// In words: which model, and how the next best compares. Empty before the first comparison.
  std::string sentence() const;

 private:
  ModelChoiceOptions options_;
  std::vector<ModelEvidence> evidence_;
  std::set<std::string> refuted_;  // names of models that were left for a richer one
  std::int64_t next_ = 0;          // count of keyframes from which the next comparison is due
};

}  // namespace camera_self_calibration
