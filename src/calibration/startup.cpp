#include "camera_self_calibration/calibration/startup.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "camera_self_calibration/calibration/growth.h"
#include "camera_self_calibration/calibration/segment_fit.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/linear_segment.h"
#include "camera_self_calibration/map/map.h"

namespace camera_self_calibration {
namespace {

// Other guesses are tried after so many keyframes, and again each time there are 3/2 as many.
constexpr int kFirstRetry = 6;
constexpr int kRetryKeyframes = 12;    // at most, in the comparison of guesses
constexpr double kClearlyLess = 0.98;  // of a cost: another minimum, not the same one again
constexpr double kHuber = 2.0;

std::vector<Camera> otherGuesses(const Camera& initial) {
  std::vector<Camera> guesses;
  const double width = initial.width();
  for (const double focal : {0.35, 0.5, 0.75, 1.1}) {
    for (const double w : {1.0, 0.6}) {
      Intrinsics parameters =
          Camera::defaultGuess(initial.model(), initial.width(), initial.height()).parameters();
      parameters(0) = parameters(1) = focal * width;
      if (initial.model() == CameraModel::kFov) parameters(4) = w;
      Camera camera = initial;
      camera.setParameters(parameters);
      guesses.push_back(camera);
      if (initial.model() != CameraModel::kFov) break;
    }
  }
  return guesses;
}

// How many keyframes of a segment end with the newest one of `solved`: usually all but one, fewer
// where keyframes came faster than they were solved, none where the two do not meet.
int keyframesUpTo(const Segment& solved, const Segment& segment) {
  if (solved.keyframes.empty()) return 0;
  int count = static_cast<int>(segment.keyframes.size());
  while (count > 0 && segment.keyframes[count - 1].id != solved.keyframes.back().id) --count;
  return count;
}

}  // namespace

double bootstrap(const StartupOptions& options, Segment* segment, Camera* camera) {
  for (Keyframe& keyframe : segment->keyframes) keyframe.world_from_camera = Rigid3();
  for (Landmark& landmark : segment->landmarks) {
    landmark.inverse_depth = 1.0;
    if (landmark.anchored) continue;
    for (const Observation& observation : segment->observations) {
      if (&segment->landmarks[observation.landmark] == &landmark) {
        if (const auto ray = camera->unproject(observation.pixel)) landmark.bearing = *ray;
        break;
      }
    }
  }
  double cost = std::numeric_limits<double>::infinity();
  for (int k = 1; k < static_cast<int>(segment->keyframes.size()); ++k) {
    cost = growByKeyframe(k, k + 1 >= options.free_after_keyframes, options.max_inverse_depth_ratio,
                          segment, camera);
  }
  return cost;
}

Startup::Startup(const StartupOptions& options, const Camera& initial) : options_(options) {
  reset(initial);
}

void Startup::reset(const Camera& initial) {
  initial_ = camera_ = initial;
  segment_ = Segment();
  information_ = IntrinsicsMatrix();
  residual_scale_ = 1.0;
  usable_ = false;
  added_ = 0;
  next_retry_ = kFirstRetry;
}

void Startup::keepKnown(Segment* segment) const {
  std::map<std::int64_t, const Keyframe*> keyframes;
  for (const Keyframe& keyframe : segment_.keyframes) keyframes[keyframe.id] = &keyframe;
  std::map<std::int64_t, const Landmark*> landmarks;
  for (const Landmark& landmark : segment_.landmarks) landmarks[landmark.track_id] = &landmark;
  for (Keyframe& keyframe : segment->keyframes) {
    const auto known = keyframes.find(keyframe.id);
    if (known != keyframes.end()) keyframe.world_from_camera = known->second->world_from_camera;
  }
  for (Landmark& landmark : segment->landmarks) {
    const auto found = landmarks.find(landmark.track_id);
    if (found == landmarks.end()) continue;
    const Landmark& known = *found->second;
    const Keyframe& known_reference = segment_.keyframes[known.reference];
    if (known_reference.id == segment->keyframes[landmark.reference].id) {
      landmark.bearing = known.bearing;
      landmark.inverse_depth = known.inverse_depth;
    } else {
      landmark.inverse_depth = transferInverseDepth(
          known_reference.world_from_camera, known.bearing, known.inverse_depth,
          segment->keyframes[landmark.reference].world_from_camera);
    }
  }
}

void Startup::add(const Segment& segment) {
  const int keyframes = static_cast<int>(segment.keyframes.size());
  if (keyframes < 2) return;
  const int known = keyframesUpTo(segment_, segment);
  Segment grown = segment;
  if (known > 0) {
    keepKnown(&grown);
    for (int k = known; k < keyframes; ++k) {
      growByKeyframe(k, k + 1 >= options_.free_after_keyframes, options_.max_inverse_depth_ratio,
                     &grown, &camera_);
    }
    added_ += keyframes - known;
  } else {
    if (!usable_) camera_ = initial_;  // a lost map is no reason to forget the lens
    bootstrap(options_, &grown, &camera_);
    added_ = keyframes;
    next_retry_ = kFirstRetry;
  }
  segment_ = grown;
  judge();
  if (added_ >= next_retry_ &&
      (!usable_ || residual_scale_ * residual_scale_ > options_.retry_cost)) {
    tryOtherGuesses(segment);
  }
}

void Startup::tryOtherGuesses(const Segment& segment) {
  next_retry_ = next_retry_ * 3 / 2;
  // Compared over the first keyframes, whatever the length of the batch: bounded time.
  const int keyframes = std::min(kRetryKeyframes, static_cast<int>(segment.keyframes.size()));
  std::vector<int> landmark_index;
  const Segment start = prefixOf(segment, keyframes, 1, &landmark_index);
  Segment present = prefixOf(segment_, keyframes, 1, &landmark_index);
  double best = usable_ ? robustCost(freeBlock(&present, camera_), camera_, kHuber)
                        : std::numeric_limits<double>::infinity();
  std::optional<Camera> better;
  for (Camera guess : otherGuesses(initial_)) {
    Segment trial = start;
    const double cost = bootstrap(options_, &trial, &guess);
    if (!(cost < kClearlyLess * best)) continue;
    best = cost;
    present = trial;
    better = guess;
  }
  if (!better) return;
  camera_ = *better;
  segment_ = segment;
  adoptPrefix(present, landmark_index, &segment_);
  for (int k = keyframes; k < static_cast<int>(segment.keyframes.size()); ++k) {
    growByKeyframe(k, true, options_.max_inverse_depth_ratio, &segment_, &camera_);
  }
  judge();
}

void Startup::judge() {
  usable_ = false;
  if (static_cast<int>(segment_.keyframes.size()) < options_.free_after_keyframes) return;
  Segment gated = segment_;
  Camera camera = camera_;
  SegmentFitOptions options;
  options.max_iterations = 10;  // from the solution of one keyframe ago
  const SegmentFit fit = fitSegment(options, &gated, &camera);
  if (!fit.usable || !camera.valid()) return;
  camera_ = camera;
  residual_scale_ = fit.residual_scale;
  const double scale = fit.marginal.sigmaScale();
  information_ = fit.marginal.information / (scale * scale);
  usable_ = true;
  if (fit.unexplained_sigma > 0.0) considerK3(gated);
  // The gated solution is the better one; tracks that did not fit stay with their old depth, since
  // they may fit later.
  std::map<std::int64_t, const Landmark*> solved;
  for (const Landmark& landmark : gated.landmarks) solved[landmark.track_id] = &landmark;
  segment_.keyframes = gated.keyframes;
  for (Landmark& landmark : segment_.landmarks) {
    const auto found = solved.find(landmark.track_id);
    if (found != solved.end()) landmark = *found->second;
  }
}

void Startup::considerK3(const Segment& gated) {
  if (camera_.model() != CameraModel::kRadtan ||
      camera_.estimatedCount() > Camera::parameterCount(CameraModel::kRadtan) ||
      static_cast<int>(gated.keyframes.size()) < kFirstRetry) {
    return;
  }
  // Both from the same state with the same observations, sigmas and effort, so that costs compare.
  SegmentFitOptions options;
  options.gating_rounds = 0;
  options.max_iterations = 40;
  Segment without_segment = gated;
  Camera without_camera = camera_;
  const SegmentFit without = fitSegment(options, &without_segment, &without_camera);
  Camera camera = camera_;
  camera.setEstimateK3(true);
  Segment with_segment = gated;
  const SegmentFit with = fitSegment(options, &with_segment, &camera);
  if (!without.usable || !with.usable || !camera.valid()) return;
  const double ratio = 2.0 * (without.marginal.cost - with.marginal.cost) /
                       std::max(1.0, without.marginal.designEffect());
  if (ratio < options_.k3_likelihood_ratio) return;
  camera_ = camera;
  const double scale = with.marginal.sigmaScale();
  information_ = with.marginal.information / (scale * scale);
}

}  // namespace camera_self_calibration
