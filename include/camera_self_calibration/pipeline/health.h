#pragma once

#include <cstdint>
#include <string>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {

enum class CalibrationState {
  kWaitingForMotion,
  kInitializing,
  kConverging,
  kConverged,
  kDegenerate
};

/// "WAITING_FOR_MOTION", "INITIALIZING", "CONVERGING", "CONVERGED", "DEGENERATE".
std::string toString(CalibrationState state);

/// What a verdict rests on.
struct HealthEvidence {
  int keyframes = 0;             ///< Seen so far.
  int maps = 1;                  ///< That they were in.
  int longest_map = 0;           ///< Keyframes of the longest of these.
  int needed_keyframes = 0;      ///< Of a map that can determine the lens: those of two segments.
  bool has_estimate = false;     ///< There is a solution with an information matrix.
  bool handed_over = false;      ///< The queue's estimate has taken over from the startup batch.
  IntrinsicsMatrix information;  ///< Of the estimate.
  PixelError uncertainty;        ///< [px]
  double seeing_share = 1.0;     ///< Of the image; the rest is dark and not counted.
  double threshold_px = 1.0;     ///< CONVERGED at or below this rms.
  double blind_below_px = 0.0;   ///< CrossValidation::blindBelowPx.
  std::uint64_t epoch = 0;       ///< How often the lens changed so far.
  std::string obstacle;          ///< Why there was no hand-over yet, in words; may be empty.
  /// The queue's segments, by more than is accepted: more of the same motion does not help.
  bool segments_disagree = false;
  /// The model in use misses the lens: beyond chance before hand-over, by more than its noise after
  /// it; and no other takes over by itself.
  bool model_misses = false;
  std::string better_model;      ///< Describes the lens then; empty: none does.
  bool model_was_given = false;  ///< Else it is chosen (`auto`).
};

/// State of the calibration with one plain sentence and the motion that would help.
struct HealthVerdict {
  CalibrationState state = CalibrationState::kWaitingForMotion;
  std::string sentence;
  std::string hint;
};

/// CONVERGED at or below the threshold, if both halves of the video tell enough of the lens to
/// check each other. CONVERGED and DEGENERATE, if they are the state `before`, are left only when a
/// limit is passed by half, so that the state does not flicker.
HealthVerdict judgeHealth(const HealthEvidence& evidence, const Camera& camera,
                          CalibrationState before);

}  // namespace camera_self_calibration
