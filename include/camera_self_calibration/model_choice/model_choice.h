#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// What speaks against a model, compared with the one in use.
struct ModelEvidence {
  std::string model;  ///< "pinhole", "fov", "radtan", "radtan with k3", "equidistant".
  bool chosen = false;
  /// By how much the model in use predicts held-out segments better: difference of their costs over
  /// the design effect [nats]; negative where this model is ahead; infinite where it fits nothing.
  double behind = 0.0;
};

struct ModelChoiceOptions {
  int min_segments = 2;       ///< Fewer can leave none out.
  int max_segments = 10;      ///< The newest that are kept before the queue holds enough.
  int segment_keyframes = 8;  ///< At least, of these.
  /// A model with as many parameters as the present one, or more, must be ahead by this [nats].
  /// With every change of the model it grows by as much again: no switching back and forth.
  double decisive = 10.0;
  /// A model with fewer parameters takes over if it is behind by no more than this [nats].
  double negligible = 3.0;
};

/// Which projection model the lens follows, by evidence: each model is fitted to several segments,
/// and its intrinsics, learnt from all but one, have to predict that one (leaveOneOut). The
/// simplest model that is not clearly worse is chosen. Compares at geometric intervals of keyframes
/// (at most 100), so that the effort per keyframe stays bounded.
class ModelChoice {
 public:
  explicit ModelChoice(const ModelChoiceOptions& options) : options_(options) {}

  /// The newest keyframes; kept for comparisons if they overlap none kept before.
  void observe(const Segment& candidate);

  /// Frees what is kept of a rolling shutter of this time between rows [s].
  void setRowTime(double row_time_s, const Camera& camera);

  /// Compares if it is time to: over `queue` (as observed, not gated) or, as long as that holds
  /// fewer than those kept by observe, over these. The camera to go on with, if it should be of
  /// another model than `present`.
  std::optional<Camera> consider(std::int64_t keyframes, const std::vector<Segment>& queue,
                                 const Camera& present, int threads);

  /// Whether the model in use has won a comparison.
  bool settled() const { return settled_; }

  /// The newest comparison, one entry a model; empty before the first.
  const std::vector<ModelEvidence>& evidence() const { return evidence_; }

  /// In words: which model, and by how much it is ahead of the next best.
  std::string sentence() const;

 private:
  std::optional<Camera> compare(const std::vector<Segment>& segments, const Camera& present,
                                int threads);

  ModelChoiceOptions options_;
  std::vector<Segment> kept_;
  std::vector<ModelEvidence> evidence_;
  std::int64_t next_ = 0;  // count of keyframes at which to compare
  int switches_ = 0;
  bool settled_ = false;
};

}  // namespace camera_self_calibration
