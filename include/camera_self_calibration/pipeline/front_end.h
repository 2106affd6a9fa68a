#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "camera_self_calibration/lens_change/innovation_monitor.h"
#include "camera_self_calibration/localization/relocalizer.h"
#include "camera_self_calibration/localization/sliding_window.h"
#include "camera_self_calibration/map/segment.h"
#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/tracking/appearance.h"
#include "camera_self_calibration/tracking/image_motion.h"
#include "camera_self_calibration/tracking/keyframe_rule.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

/// What learning starts from: at the first image, after a reset, from a saved state.
struct Beginning {
  std::uint64_t number = 0;  ///< Grows; what was learnt from an older one is void.
  Camera camera;
  std::shared_ptr<const LearntState> state;  ///< Null: nothing is known but `camera`.
};

/// From the back end to the front end: newest intrinsics.
struct CalibrationUpdate {
  Camera camera;
  std::uint64_t generation = 0;
  std::uint64_t beginning = 0;  ///< Beginning::number of what it was learnt from.
  bool handed_over = false;
  double uncertainty_px = std::numeric_limits<double>::infinity();  ///< Of the camera, rms.
  /// Startup: poses and depths solved together with the intrinsics.
  std::optional<Segment> solution;
  std::uint64_t epoch = 0;
  double line_delay_s = 0.0;  ///< Of the rolling shutter, between rows [s].
  std::int64_t onset_ns = 0;  ///< Of the epoch: stamp of the first keyframe with the present lens.
};

/// From the front end to the back end: a keyframe, when the motion of features in it is known.
struct KeyframeMessage {
  std::shared_ptr<const Beginning> beginning;
  std::int64_t keyframes = 0;  ///< Count since the start.
  Segment candidate;           ///< The last n keyframes until this one.
  Segment history;             ///< For the startup batch; empty after hand-over.
  /// When the tracks began to fit less well than usual [ns]; 0: they do not (InnovationMonitor).
  std::int64_t suspected_onset_ns = 0;
  ImageField field = {};  ///< The part of the image that sees the scene, as far as known.
};

struct FrontEndOutput {
  FrameResult result;
  std::optional<KeyframeMessage> keyframe;  ///< Of this frame, or of one shortly before.
  std::vector<std::int64_t> outliers;       ///< Tracks to end.
  std::vector<Event> events;
  bool restart_tracking = false;  ///< The map was lost: end all tracks, detect anew.
  bool contradicted = false;      ///< It was, although enough features could be followed.
};

/// Thread 1: from the tracks of one image to its pose, and at keyframes through the sliding window.
class FrontEnd {
 public:
  /// Keyframes are counted from `first_keyframe`.
  FrontEnd(const Options& options, const Camera& camera, std::int64_t first_keyframe = 0);

  /// Frames in the order of time. `detect` is called when the frame becomes a keyframe, `describe`
  /// at some of the keyframes; without it a map that was lost is not found again.
  FrontEndOutput process(const TrackedFrame& seen,
                         const std::function<std::vector<Track>()>& detect,
                         const Describe& describe = nullptr);

  void adopt(const CalibrationUpdate& update);

  /// The intrinsics of the map.
  const Camera& camera() const { return window_.camera(); }

  /// Whether the intrinsics are learnt rather than those it began with.
  bool knowsLens() const { return knows_lens_; }

  /// Starts a new map at the next frame, from the last pose; the calibration stays, and the present
  /// map may be found again.
  void resetMap();

  /// No older map is found again.
  void forgetOlderMaps() { relocalizer_.clear(); }

  /// Forgets the calibration too: a new map with these intrinsics, keyframes counted from
  /// `first_keyframe`.
  void restart(const Camera& camera, std::int64_t first_keyframe);

  /// Multiplies all lengths of the map, which gets a new map_id since its poses no longer compare
  /// with those before; `factor` > 0. Older maps, whose scale is another one, are forgotten.
  void scaleMap(double factor);

 private:
  void adoptHeld(const Camera& camera);
  void locate(const TrackedFrame& frame, FrontEndOutput* output);
  void makeKeyframe(const TrackedFrame& frame, std::vector<Track> detected,
                    const Describe& describe, FrontEndOutput* output);
  void seekOlderMap(const TrackedFrame& whole, const Describe& describe, FrontEndOutput* output);
  double keyframeSpacing() const;
  void watchLens(const TrackedFrame& frame, const PoseEstimate& pose);
  std::optional<std::int64_t> keyframeToHandOn(const FrontEndOutput& output) const;
  KeyframeMessage keyframeMessage(std::int64_t stamp_ns) const;
  bool mayRoll() const { return options_.estimate_readout || options_.readout_s != 0.0; }
  TrackedFrame withMotion(const TrackedFrame& frame);
  void resumeTracking(const TrackedFrame& frame);
  void missPose(const TrackedFrame& frame, FrontEndOutput* output);

  Options options_;
  SlidingWindow window_;
  KeyframeRule keyframe_rule_;
  Relocalizer relocalizer_;
  InnovationMonitor monitor_;
  MotionHistory motions_;
  bool handed_over_ = false;
  bool knows_lens_ = false;
  bool well_known_ = false;  // the lens
  std::uint64_t epoch_ = 0;
  std::int64_t epoch_onset_ns_ = 0;
  std::int64_t keyframes_ = 0;
  std::uint64_t map_id_ = 0;
  std::uint64_t next_map_id_ = 1;
  TrackingState state_ = TrackingState::kInitializing;
  std::optional<MapMove> moved_;  // not reported yet
  bool map_tracked_ = false;      // a pose was found in this map
  bool loss_reported_ = false;    // and tracking is not back yet
  int frames_without_pose_ = 0;
  Rigid3 world_from_camera_;        // of the last frame with a pose
  Rigid3 last_motion_;              // from it to the one with a pose before it
  std::int64_t last_stamp_ns_ = 0;  // of the last frame with a pose
};

}  // namespace camera_self_calibration
