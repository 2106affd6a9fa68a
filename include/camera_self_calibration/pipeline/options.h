#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/queue/score_kind.h"
#include "camera_self_calibration/tracking/tracking_options.h"

namespace camera_self_calibration {

/// Every option of the pipeline, one struct for the nodelet, the offline tool and tests.
struct Options {
  /// None: the simplest that describes the lens, starting with that of initial_camera, or pinhole.
  std::optional<CameraModel> model;
  /// Start values of the intrinsics; none: Camera::defaultGuess of the first image's size.
  std::optional<Camera> initial_camera;
  /// Takes initial_camera as exact: poses only, nothing is calibrated.
  bool fix_intrinsics = false;

  TrackerOptions tracker;
  KeyframeOptions keyframe;

  int sliding_window_keyframes = 10;  ///< Active keyframes of the sliding window.
  int segment_keyframes = 10;         ///< Keyframes of a candidate window and of a segment.
  int queue_segments = 10;            ///< Segments in the queue.
  /// Landmarks on the exact ray of their reference pixel (eq. 1), instead of counting that pixel as
  /// one measurement among others.
  bool exact_references = false;
  int startup_keyframes = 30;             ///< At most, in the startup batch.
  double alpha = 0.95;                    ///< Update rule of the queue, in (0, 1) (section II-B).
  ScoreKind score = ScoreKind::kEntropy;  ///< What makes one segment better than another.
  /// Hand-over from the startup batch also below this normalised entropy [nats]; -infinity: only by
  /// pixel uncertainty.
  double handover_entropy = -std::numeric_limits<double>::infinity();
  /// Estimates the readout time of a rolling shutter; `readout_s` is where it starts.
  bool estimate_readout = true;
  /// From the first row to the last, known or not [s]; 0: a global shutter. Negative where the
  /// lower rows are read first.
  double readout_s = 0.0;
  double converged_pixel_rms = 0.0;  ///< CONVERGED below this [px]; 0: 1 px per 640 px of side.
  /// Alarms of the change detection per hour while nothing changes; 0: no alarm ever.
  double false_alarms_per_hour = 0.1;
  /// Keyframes remembered at most to recognise a map that was lost; 0: it is never sought.
  int relocalization_keyframes = 100;
  int solver_threads = 1;     ///< That share the fits of the back end; result independent.
  int max_queued_images = 2;  ///< Live: images waiting before the oldest is dropped.

  /// Of the first estimate.
  CameraModel firstModel() const;

  /// The same with this calibration taken as exact.
  Options withHeld(const Camera& camera) const;

  /// rms uncertainty that counts as converged for this camera's images [px].
  double convergedRms(const Camera& camera) const;

  /// Every violated bound in one sentence each; empty if all is well.
  std::vector<std::string> problems() const;
};

/// Options::convergedRms with `asked_px` for converged_pixel_rms [px].
double convergedRms(double asked_px, const Camera& camera);

/// "auto": the readout time is estimated; "off": a global shutter; or a number: the readout time of
/// the whole image [s]. False, and nothing changed, for anything else.
bool setRollingShutter(const std::string& text, Options* options);

}  // namespace camera_self_calibration
