#include "camera_self_calibration/pipeline/front_end.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/map/rolling_shutter.h"
#include "camera_self_calibration/tracking/tracker.h"

namespace camera_self_calibration {
namespace {

// Fewer tracks than this determine no pose worth having.
constexpr int kMinTracks = 12;
// Residual scale, in the tracker's sigmas, of a pose that needs no second guess to start from.
constexpr double kGoodFit = 2.0;
// Below this share of the image's longer side [rms] a calibration gains little from one more
// keyframe: they may stand further apart and leave the processor to others.
constexpr double kWellKnown = 0.1 / 640.0;
constexpr double kWideSpacing = 2.0;
constexpr double kSuspiciousSpacing = 0.5;
// Frames in a row without a pose after which the map is given up.
constexpr int kFramesUntilLost = 5;

SlidingWindowOptions windowOptions(const Options& options) {
  SlidingWindowOptions window;
  window.active_keyframes = options.sliding_window_keyframes;
  window.conditioning_keyframes = options.sliding_window_keyframes;
  window.exact_references = options.exact_references;
  window.map_keyframes = std::max({options.startup_keyframes, options.segment_keyframes,
                                   window.active_keyframes + window.conditioning_keyframes});
  return window;
}

bool hasEnoughTracks(const TrackedFrame& frame) {
  return static_cast<int>(frame.tracks.size()) >= kMinTracks;
}

// And what to do about it.
std::string whyNoPose(const TrackedFrame& frame) {
  const std::string tracks = std::to_string(frame.tracks.size());
  if (frame.unrelated) {
    return "the image shows nothing of what was tracked before: a cut, missing images, or "
           "something in front of the lens";
  }
  if (hasEnoughTracks(frame)) {
    return "no pose agrees with the " + tracks +
           " features. Move more slowly, or look at something that stands still";
  }
  return "only " + tracks + " features could be tracked; " + std::to_string(kMinTracks) +
         " are needed. Move more slowly, or show the camera more texture";
}

}  // namespace

FrontEnd::FrontEnd(const Options& options, const Camera& camera, std::int64_t first_keyframe)
    : options_(options),
      window_(windowOptions(options), camera),
      keyframe_rule_(options.keyframe),
      relocalizer_(options.relocalization_keyframes),
      keyframes_(first_keyframe) {
  window_.setLineDelay(options_.readout_s / rowSteps(camera.height()));
  if (options_.fix_intrinsics) adoptHeld(camera);
}

void FrontEnd::adoptHeld(const Camera& camera) {
  CalibrationUpdate held;
  held.line_delay_s = window_.map().lineDelayS();
  held.camera = camera;
  held.handed_over = true;
  adopt(held);
}

void FrontEnd::adopt(const CalibrationUpdate& update) {
  handed_over_ = update.handed_over;
  // A beginning that follows another one is sent as well, though nothing is known yet.
  knows_lens_ = handed_over_ || std::isfinite(update.uncertainty_px);
  well_known_ = handed_over_ && update.uncertainty_px < kWellKnown * update.camera.longerSide();
  const Rigid3 newest = window_.newestPose();
  if (update.epoch != epoch_) {
    epoch_ = update.epoch;
    // A later one is of a map that is gone, by a clock that was set back since: all of this map is
    // of the present lens.
    const std::deque<Keyframe>& keyframes = window_.map().keyframes();
    const bool in_map = !keyframes.empty() && update.onset_ns <= keyframes.back().stamp_ns;
    epoch_onset_ns_ = in_map ? update.onset_ns : 0;
    window_.changeLens(epoch_onset_ns_);
    monitor_.reset();
  }
  if (update.line_delay_s != window_.map().lineDelayS()) window_.setLineDelay(update.line_delay_s);
  if (update.solution) {
    window_.adopt(update.camera, update.generation, update.handed_over, *update.solution);
  } else {
    window_.adopt(update.camera, update.generation, update.handed_over);
  }
  // Frames since the newest keyframe are located again from the next on. It kept its pose, but
  // soon after a change of the lens.
  world_from_camera_ = window_.newestPose() * (newest.inverse() * world_from_camera_);
}

void FrontEnd::resetMap() {
  window_.clear();
  epoch_onset_ns_ = 0;  // all that comes is of the present lens, whatever its clock says
  monitor_.reset();
  keyframe_rule_.reset();
  motions_.clear();
  map_id_ = next_map_id_++;
  state_ = TrackingState::kInitializing;
  map_tracked_ = false;
  frames_without_pose_ = 0;
  last_motion_ = Rigid3();
}

void FrontEnd::restart(const Camera& camera, std::int64_t first_keyframe) {
  window_ = SlidingWindow(windowOptions(options_), camera);
  window_.setLineDelay(options_.readout_s / rowSteps(camera.height()));
  resetMap();
  relocalizer_.clear();
  handed_over_ = knows_lens_ = well_known_ = false;
  loss_reported_ = false;
  epoch_ = 0;
  keyframes_ = first_keyframe;
  world_from_camera_ = Rigid3();
  if (options_.fix_intrinsics) adoptHeld(camera);
}

void FrontEnd::scaleMap(double factor) {
  const Similarity3 scaled{Rigid3(), factor};
  window_.move(scaled);
  world_from_camera_ = scaled * world_from_camera_;
  last_motion_.translation *= factor;
  relocalizer_.scaleMap(map_id_, next_map_id_, factor);
  moved_ = MapMove{map_id_, next_map_id_, scaled};
  map_id_ = next_map_id_++;
}

// How the features move, for this image, and better now for the images before it.
TrackedFrame FrontEnd::withMotion(const TrackedFrame& frame) {
  TrackedFrame moving = frame;
  if (!mayRoll() || frame.unrelated) return moving;
  motions_.add(frame);
  for (int ago = 1; ago < std::min(motions_.size(), MotionHistory::kReach + 1); ++ago) {
    if (window_.hasKeyframe(motions_.stampNs(ago))) {
      window_.setMotions(motions_.stampNs(ago), motions_.motions(ago));
    }
  }
  const std::map<std::int64_t, ImageMotion> now = motions_.motions(0);
  for (Track& track : moving.tracks) track.motion = now.at(track.id);
  return moving;
}

FrontEndOutput FrontEnd::process(const TrackedFrame& seen,
                                 const std::function<std::vector<Track>()>& detect,
                                 const Describe& describe) {
  const TrackedFrame frame = withMotion(seen);
  FrontEndOutput output;
  output.result.stamp_ns = frame.stamp_ns;
  window_.forget(frame.carried);
  locate(frame, &output);
  const bool first = window_.map().keyframes().empty();
  const bool due = frames_without_pose_ == 0 &&
                   keyframe_rule_.isKeyframe(frame, window_.camera(), keyframeSpacing());
  if (!output.restart_tracking && (first || due)) {
    makeKeyframe(frame, detect(), describe, &output);
  }
  const auto stamp_ns = frame.unrelated ? std::nullopt : keyframeToHandOn(output);
  if (stamp_ns) {
    output.keyframe = keyframeMessage(*stamp_ns);
    output.keyframe->field = frame.field;
  }
  for (Event& event : output.events) event.epoch = epoch_;
  output.result.state = state_;
  output.result.map_id = map_id_;
  output.result.moved = std::exchange(moved_, std::nullopt);
  output.result.world_from_camera = world_from_camera_;
  output.result.calibration_revision = window_.generation();
  if (output.result.sentence.empty()) {
    output.result.sentence = state_ == TrackingState::kTracking
                                 ? std::to_string(frame.tracks.size()) + " features tracked"
                             : output.result.is_keyframe
                                 ? "a new map begins with this image"
                                 : "waiting for an image with enough texture";
  }
  return output;
}

void FrontEnd::locate(const TrackedFrame& frame, FrontEndOutput* output) {
  if (window_.map().keyframes().empty()) return;
  PoseEstimate pose = window_.localize(frame, world_from_camera_ * last_motion_);
  if (!pose.usable || pose.residual_scale > kGoodFit) {
    const PoseEstimate still = window_.localize(frame, world_from_camera_);
    if (!pose.usable || (still.usable && still.residual_scale < pose.residual_scale)) pose = still;
  }
  const bool located = pose.usable && pose.inliers >= kMinTracks;
  if (located) {
    last_motion_ = world_from_camera_.inverse() * pose.world_from_camera;
    world_from_camera_ = pose.world_from_camera;
    output->result.pose_covariance = pose.covariance;
    watchLens(frame, pose);
    resumeTracking(frame);
  } else {
    missPose(frame, output);
  }
}

// Whether the lens has changed is to be settled soon.
double FrontEnd::keyframeSpacing() const {
  if (monitor_.suspicious()) return kSuspiciousSpacing;
  return well_known_ ? kWideSpacing : 1.0;
}

void FrontEnd::watchLens(const TrackedFrame& frame, const PoseEstimate& pose) {
  if (!handed_over_) return;
  monitor_.add(frame.stamp_ns, pose.residual_scale);
  // By then a whole window lies behind the suspected onset, and the back end has made up its mind.
  if (monitor_.suspicious() &&
      window_.map().keyframesSince(monitor_.onsetNs()) > options_.segment_keyframes) {
    monitor_.reset();
  }
}

void FrontEnd::resumeTracking(const TrackedFrame& frame) {
  frames_without_pose_ = 0;
  last_stamp_ns_ = frame.stamp_ns;
  map_tracked_ = true;
  state_ = TrackingState::kTracking;
  loss_reported_ = false;
}

// A frame without a pose is LOST at once, since its pose is not known; the map is given up later.
void FrontEnd::missPose(const TrackedFrame& frame, FrontEndOutput* output) {
  if (state_ == TrackingState::kTracking) state_ = TrackingState::kLost;
  ++frames_without_pose_;
  output->result.sentence = whyNoPose(frame);
  if (frames_without_pose_ < kFramesUntilLost) return;
  const bool was_tracked = map_tracked_;
  resetMap();
  output->restart_tracking = true;
  output->contradicted = hasEnoughTracks(frame);
  if (was_tracked || loss_reported_) state_ = TrackingState::kLost;
  if (!was_tracked) return;
  loss_reported_ = true;
  const std::string what =
      frame.unrelated ? "the images show nothing of what was tracked" : "tracking was lost";
  output->events.push_back({EventType::kLost, frame.stamp_ns, frame.stamp_ns,
                            what + "; the calibration is kept and a new map begins"});
}

// Stamp of the keyframe to hand on at this frame, if there is one. It has to be known how features
// moved in it, which takes images from after it too: what is wrong with the motion in a keyframe is
// wrong with its pixels. The first one of a map says nothing but that the map begins.
std::optional<std::int64_t> FrontEnd::keyframeToHandOn(const FrontEndOutput& output) const {
  const auto& keyframes = window_.map().keyframes();
  if (output.result.is_keyframe && (!mayRoll() || keyframes.size() == 1)) {
    return keyframes.back().stamp_ns;
  }
  if (!mayRoll() || motions_.size() <= MotionHistory::kReach) return std::nullopt;
  const std::int64_t stamp_ns = motions_.stampNs(MotionHistory::kReach);
  if (!window_.hasKeyframe(stamp_ns) || keyframes.front().stamp_ns == stamp_ns) return std::nullopt;
  return stamp_ns;
}

KeyframeMessage FrontEnd::keyframeMessage(std::int64_t stamp_ns) const {
  const Map& map = window_.map();
  const int newer = map.keyframesSince(stamp_ns) - 1;
  KeyframeMessage message;
  message.keyframes = keyframes_ - newer;
  // With the present lens: one at least, though time may have jumped back to before its onset.
  const int present = std::max(1, map.keyframesSince(epoch_onset_ns_) - newer);
  message.candidate =
      map.lastKeyframes(std::min(options_.segment_keyframes, present), window_.camera(), newer);
  if (!handed_over_) {
    // With what is known of the scene from before a change, which makes few keyframes suffice.
    message.history = map.lastKeyframes(options_.startup_keyframes, window_.camera(), newer);
  }
  // A suspicion of later images is none of this keyframe's.
  const bool suspected = monitor_.suspicious() && monitor_.onsetNs() <= stamp_ns;
  message.suspected_onset_ns = suspected ? monitor_.onsetNs() : 0;
  return message;
}

// Where the newest keyframe shows a place of an older map, all goes on in that one.
void FrontEnd::seekOlderMap(const TrackedFrame& whole, const Describe& describe,
                            FrontEndOutput* output) {
  // A track that is poor by now no longer looks as the place does.
  std::vector<Track> good;
  std::copy_if(whole.tracks.begin(), whole.tracks.end(), std::back_inserter(good),
               [](const Track& track) { return track.sigma <= kGoodTrackSigma; });
  const auto relocation = relocalizer_.atKeyframe(map_id_, window_.map(), window_.camera(), good,
                                                  knowsLens(), describe);
  if (!relocation) return;
  const std::uint64_t left = std::exchange(map_id_, relocation->map_id);
  moved_ = MapMove{left, map_id_, relocation->old_from_new};
  window_.move(relocation->old_from_new);
  last_motion_.translation *= relocation->old_from_new.scale;
  // The position's part is in the axes of the map.
  const Eigen::Matrix3d turn =
      relocation->old_from_new.scale * relocation->old_from_new.motion.rotation.toRotationMatrix();
  Matrix6d& covariance = output->result.pose_covariance;
  covariance.topRows<3>() = (turn * covariance.topRows<3>()).eval();
  covariance.leftCols<3>() = (covariance.leftCols<3>() * turn.transpose()).eval();
  output->events.push_back({EventType::kRelocalized, whole.stamp_ns, whole.stamp_ns,
                            "the camera recognised a place of an earlier map: poses are in map " +
                                std::to_string(map_id_) + " again, no longer in map " +
                                std::to_string(left) + " (" + std::to_string(relocation->seen) +
                                " features agree)"});
}

void FrontEnd::makeKeyframe(const TrackedFrame& frame, std::vector<Track> detected,
                            const Describe& describe, FrontEndOutput* output) {
  TrackedFrame whole = frame;
  whole.tracks.insert(whole.tracks.end(), detected.begin(), detected.end());
  if (motions_.size() > 0) motions_.addDetected(detected);
  if (!hasEnoughTracks(whole)) return;

  Keyframe keyframe;
  keyframe.id = keyframes_++;
  keyframe.stamp_ns = frame.stamp_ns;
  keyframe.world_from_camera = world_from_camera_;
  const double seconds = toSeconds(frame.stamp_ns - last_stamp_ns_);
  if (seconds > 0.0 && keyframe.id > 0) keyframe.velocity = logSe3(last_motion_) / seconds;
  output->outliers = window_.addKeyframe(keyframe, whole.tracks);
  seekOlderMap(whole, describe, output);
  world_from_camera_ = window_.newestPose();
  keyframe_rule_.setKeyframe(whole);
  output->result.is_keyframe = true;
  output->result.keyframe_id = keyframe.id;
  last_stamp_ns_ = frame.stamp_ns;
}

}  // namespace camera_self_calibration
