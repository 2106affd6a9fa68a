#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/gate.h"
#include "camera_self_calibration/estimation/pose_solver.h"
#include "camera_self_calibration/estimation/problem.h"
#include "camera_self_calibration/map/map.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

struct SlidingWindowOptions {
  int active_keyframes = 10;
  int conditioning_keyframes = 10;
  int map_keyframes = 40;                     ///< Kept in all, at least active + conditioning.
  bool exact_references = false;              ///< See Map.
  double max_generation_distance_px = 0.5;    ///< Between intrinsics, for conditioning keyframes.
  double gross_residual_share = kGrossShare;  ///< Smaller residuals end no track.
};

/// Where the camera is, with the intrinsics held (section II-C): the pose of each frame against the
/// map, and at keyframes the poses and landmarks of the active window, conditioned on older
/// keyframes that see the same landmarks.
class SlidingWindow {
 public:
  SlidingWindow(const SlidingWindowOptions& options, const Camera& camera);

  /// Adopts a new estimate of the intrinsics: re-solves the active window unconditioned, keeping
  /// the newest pose and the median depth there, so that neither pose nor scale jumps; a change far
  /// below the tracks' errors is left to the next keyframe. Keyframes before it whose intrinsics
  /// differ by more than the option's distance condition no more. Only intrinsics that are
  /// `trusted` end tracks that do not fit: under wrong ones good tracks do not fit either.
  void adopt(const Camera& camera, std::uint64_t generation, bool trusted);

  /// The same where keyframes and tracks were solved with these intrinsics elsewhere (reseed): the
  /// window is solved again only if it has newer keyframes than the solution.
  void adopt(const Camera& camera, std::uint64_t generation, bool trusted, const Segment& solution);

  /// The physical camera changed at this stamp: older keyframes keep the present intrinsics for
  /// ever, whatever is adopted from now on.
  void changeLens(std::int64_t onset_ns) { map_.changeLens(onset_ns, camera_, camera_); }

  const Camera& camera() const { return camera_; }
  std::uint64_t generation() const { return generation_; }
  const Map& map() const { return map_; }

  /// Replaces poses and depths by those of a solution of the same keyframes and tracks, such as the
  /// startup batch's, moved and scaled to keep the newest pose and the median depth there. Where it
  /// reaches back beyond a change of the lens, those of its oldest keyframe are kept: what came
  /// since the change was estimated with the wrong lens at first.
  void reseed(const Segment& solution);

  /// The pose of a frame from the map's points alone; `guess` should be near.
  PoseEstimate localize(const TrackedFrame& frame, const Rigid3& guess) const;

  /// Adds a keyframe (its pose a first guess; generation is set here), with the frame's tracks and
  /// those that start in it, and solves the window. Returns the tracks that do not fit, before (the
  /// pose, see movingTracks) or after; they are out of the map.
  std::vector<std::int64_t> addKeyframe(Keyframe keyframe, const std::vector<Track>& tracks);

  /// Takes tracks out of the map that are not of the scene.
  void forget(const std::vector<std::int64_t>& tracks) { map_.removePoints(tracks); }

  /// The rolling shutter's time between rows, which the map's pixels and those of frames to come
  /// are freed of [s].
  void setLineDelay(double line_delay_s) { map_.setLineDelay(line_delay_s, camera_.height()); }

  bool hasKeyframe(std::int64_t stamp_ns) const { return keyframeAt(stamp_ns) != nullptr; }
  /// Tells how tracks move in the keyframe of this stamp, if it is one.
  void setMotions(std::int64_t stamp_ns, const std::map<std::int64_t, ImageMotion>& motions);

  /// Newest keyframe's pose; identity without any.
  Rigid3 newestPose() const;

  /// Forgets the map, keeps the camera.
  void clear() {
    map_.clear();
    told_inverse_depth_ = 1.0;
  }

  /// Takes the map over into another world.
  void move(const Similarity3& other_from_world) {
    map_.move(other_from_world);
    told_inverse_depth_ /= other_from_world.scale;
  }

 private:
  // An estimate of the calibration, and the length of the way to it from the first one on [px rms]:
  // two are no further apart than their ways differ.
  struct Generation {
    Camera camera;
    double way_px = 0.0;
  };

  bool negligiblyFarFrom(const Camera& camera) const;
  void setCamera(const Camera& camera, std::uint64_t generation, bool trusted);
  void solveUnconditioned();
  void locateNewerThan(const Segment& solution);
  const Keyframe* keyframeAt(std::int64_t stamp_ns) const;
  std::optional<PointView> viewOf(const Map::Point& point, const Track& track) const;
  std::vector<std::int64_t> tracksAtOdds(const Rigid3& pose,
                                         const std::vector<Track>& tracks) const;
  double typicalInverseDepthOf(const std::vector<std::int64_t>& track_ids,
                               const Keyframe& keyframe) const;
  bool nearTrueCamera(const Keyframe& keyframe) const;
  int conditioningCount() const;
  void takeGeneration(Segment* segment) const;
  void rememberInverseDepth(const Segment& segment, int fixed_keyframes);
  bool solveActive(const SegmentBlock& block, const SegmentBlock& unconditioned);
  std::vector<std::int64_t> solveWindow();

  SlidingWindowOptions options_;
  Camera camera_;
  std::uint64_t generation_ = 0;
  bool trusted_ = false;
  std::map<std::uint64_t, Generation> generations_;  // of the keyframes in the map
  Map map_;
  // Median when parallax last determined it; at first that of new points. Where nothing determines
  // the depths, such as while the camera turns on the spot, they and the scale stay about there,
  // and in front of the camera. The present median would not do: without true parallax, the noise
  // of the translations lowers it with every solution.
  double told_inverse_depth_ = 1.0;
};

}  // namespace camera_self_calibration
