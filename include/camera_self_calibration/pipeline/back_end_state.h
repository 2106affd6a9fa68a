#pragma once

#include <cstdint>
#include <string>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/image_field.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/lens_change/setting_archive.h"
#include "camera_self_calibration/model_choice/lens_fit.h"
#include "camera_self_calibration/model_choice/model_choice.h"
#include "camera_self_calibration/pipeline/health.h"
#include "camera_self_calibration/pipeline/lens_watch.h"
#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/pipeline/phase.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/pipeline/shutter.h"
#include "camera_self_calibration/queue/cross_validation.h"
#include "camera_self_calibration/queue/segment_queue.h"
#include "camera_self_calibration/startup/startup.h"

namespace camera_self_calibration {

/// What goes on counting whenever learning begins again, so that no number is given twice.
struct Counters {
  std::uint64_t revision = 0;  ///< Of the newest estimate.
  std::uint64_t epoch = 0;     ///< Of the lens.
};

/// The intrinsics in use.
struct KnownLens {
  Camera camera;
  IntrinsicsMatrix covariance;  ///< n_c x n_c; empty until there is an estimate.
  /// Uncertainty over the part of the image that sees, with what halves of the video disagree
  /// beyond it, without any misfit of the model [px].
  PixelError noise = PixelError::unknown();
  // Of the queue's estimate only:
  CrossValidation cross_validation;
  ImageField observed_area;  ///< Where features were.
  ObservedReport observed;
};

/// What became of a keyframe's candidate.
struct CandidateOutcome {
  bool accepted = false;  ///< By the queue.
  std::string reason;     ///< In words.
};

/// All that the back end knows: what it has learnt, and what the newest keyframe said. Reports are
/// made from it (back_end_report.h).
struct BackEndState {
  BackEndState(const Options& options, const Camera& camera);

  /// Of `known`, with the misfit of the model [px].
  PixelError uncertainty() const { return known.noise.inQuadrature(lens_fit.report().misfit); }

  /// Seen of the present lens.
  std::int64_t keyframesOfLens() const { return keyframes - earlier_keyframes; }

  bool chooses_model;     ///< Else it was given.
  int segment_keyframes;  ///< Of a segment.
  Phase phase = Phase::kNothingKnown;
  KnownLens known;
  Startup startup;
  SegmentQueue queue;
  Shutter shutter;
  LensWatch watch;
  SettingArchive settings;  ///< Of earlier epochs.
  ModelChoice model_choice;
  LensFit lens_fit;
  HealthVerdict health;
  Counters counters;
  int swaps = 0;                    ///< Changes of the queue since the start.
  std::string last_change;          ///< Of the lens, in words; empty if there was none.
  std::int64_t last_change_ns = 0;  ///< When it began.

  std::int64_t stamp_ns = 0;   ///< Of the newest keyframe.
  std::int64_t keyframes = 0;  ///< Seen so far.
  /// Of them, those of earlier lenses, or from before this start.
  std::int64_t earlier_keyframes = 0;
  int maps = 0;                  ///< That keyframes of this start were in.
  std::int64_t map_begin = 0;    ///< `keyframes` at the first of the present map.
  std::int64_t longest_map = 0;  ///< Keyframes of the longest of these maps.
  ImageField field;              ///< The part of the image that sees.
  CandidateOutcome outcome;      ///< Of its candidate.
  double change_p_value = 1.0;   ///< Of the newest test whether the lens is still the same.
  std::string obstacle;          ///< To hand-over, in words; empty if there is none.
};

}  // namespace camera_self_calibration
