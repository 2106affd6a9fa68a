#include "camera_self_calibration/localization/sliding_window.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/localization/moving_tracks.h"
#include "camera_self_calibration/map/inverse_depth.h"
#include "camera_self_calibration/map/segment_edit.h"
#include "camera_self_calibration/tracking/image_motion.h"

namespace camera_self_calibration {
namespace {

// Baseline over depth below which poses do not fix the scale, nor the depths.
constexpr double kSeparatedPoses = 1e-2;

// Intrinsics as near as this to those that the window was solved with, far below the tracker's
// sigma, change nothing that the next keyframe's solution will not see to.
constexpr double kNegligiblePx = 0.02;

constexpr int kNearIterations = 8;  // a window moves little by one keyframe more
constexpr int kFarIterations = 30;  // without depths to start from
// Costs of rough solutions that differ by less are of one minimum.
constexpr double kSameMinimum = 1.0 - kRoughPrecision * kRoughPrecision;

// With so many points of estimated depth in view, points of guessed depth are not needed.
constexpr std::size_t kEnoughKnownPoints = 15;

// Landmarks that fixed keyframes alone see: they tell nothing of the others.
std::vector<int> seenByFixedAlone(const Segment& segment, int fixed_keyframes) {
  std::vector<char> alone(segment.landmarks.size(), 1);
  for (const Observation& observation : segment.observations) {
    if (observation.keyframe >= fixed_keyframes) alone[observation.landmark] = 0;
  }
  std::vector<int> result;
  for (std::size_t l = 0; l < alone.size(); ++l) {
    if (alone[l] != 0) result.push_back(static_cast<int>(l));
  }
  return result;
}

int newest(const Segment& segment) { return static_cast<int>(segment.keyframes.size()) - 1; }

// Whether the poses from keyframe `first` on are far enough from the newest to tell depths.
bool hasParallax(const Segment& segment, int first) {
  const Eigen::Vector3d place = segment.keyframes.back().world_from_camera.translation;
  double baseline = 0.0;
  for (std::size_t k = first; k < segment.keyframes.size(); ++k) {
    const Eigen::Vector3d& position = segment.keyframes[k].world_from_camera.translation;
    baseline = std::max(baseline, (position - place).norm());
  }
  return baseline * std::abs(medianInverseDepth(segment, 0.0)) > kSeparatedPoses;
}

SolverOptions windowSolver(int max_iterations = kNearIterations) {
  SolverOptions options;
  options.max_iterations = max_iterations;
  options.precision = kRoughPrecision;
  return options;
}

// The inverse depth that holds the scale.
double scaleOf(const SegmentBlock& block) {
  const Segment& segment = *block.segment;
  const double held =
      block.fixed_landmark < 0 ? 0.0 : segment.landmarks[block.fixed_landmark].inverse_depth;
  return held > 0.0 ? held : typicalInverseDepth(inverseDepths(segment));
}

}  // namespace

SlidingWindow::SlidingWindow(const SlidingWindowOptions& options, const Camera& camera)
    : options_(options), camera_(camera), map_(options.map_keyframes, options.exact_references) {
  generations_[generation_] = {camera_, 0.0};
}

Rigid3 SlidingWindow::newestPose() const {
  return map_.keyframes().empty() ? Rigid3() : map_.keyframes().back().world_from_camera;
}

// Keyframes from before a change of the lens keep the generation that they were estimated with.
void SlidingWindow::takeGeneration(Segment* segment) const {
  for (std::size_t k = 0; k < segment->keyframes.size(); ++k) {
    if (segment->isLensHeld(static_cast<int>(k))) continue;
    segment->keyframes[k].calibration_generation = generation_;
  }
}

bool SlidingWindow::negligiblyFarFrom(const Camera& camera) const {
  const auto& keyframes = map_.keyframes();
  const std::size_t active =
      std::min(keyframes.size(), static_cast<std::size_t>(options_.active_keyframes));
  if (active == 0) return false;
  const auto solved_with = generations_.find((keyframes.end() - active)->calibration_generation);
  return solved_with != generations_.end() &&
         pixelDistance(solved_with->second.camera, camera).rms < kNegligiblePx;
}

void SlidingWindow::adopt(const Camera& camera, std::uint64_t generation, bool trusted) {
  const bool solve_again = !negligiblyFarFrom(camera);
  setCamera(camera, generation, trusted);
  if (solve_again) solveUnconditioned();
}

void SlidingWindow::adopt(const Camera& camera, std::uint64_t generation, bool trusted,
                          const Segment& solution) {
  const bool newest = !map_.keyframes().empty() && !solution.keyframes.empty() &&
                      map_.keyframes().back().id == solution.keyframes.back().id;
  setCamera(camera, generation, trusted);
  reseed(solution);
  if (!newest) {
    locateNewerThan(solution);
    solveUnconditioned();
  }
}

// Keyframes that a solution does not know, against the landmarks that it moved.
void SlidingWindow::locateNewerThan(const Segment& solution) {
  if (solution.keyframes.empty() || map_.keyframes().size() < 2) return;
  Segment segment = map_.lastKeyframes(options_.active_keyframes, camera_);
  for (int k = 1; k <= newest(segment); ++k) {
    if (segment.keyframes[k].id <= solution.keyframes.back().id) continue;
    const std::vector<PointView> views = earlierPointsSeenIn(k, segment, camera_);
    Rigid3& pose = segment.keyframes[k].world_from_camera;
    const PoseEstimate located = solvePose(segment.cameraOf(k, camera_), views, pose);
    if (located.usable) pose = located.world_from_camera;
  }
  map_.update(segment);
}

void SlidingWindow::setCamera(const Camera& camera, std::uint64_t generation, bool trusted) {
  const double way_px = generations_[generation_].way_px + pixelDistance(camera_, camera).rms;
  trusted_ = trusted;
  camera_ = camera;
  generation_ = generation;
  std::set<std::uint64_t> used;
  for (const Keyframe& keyframe : map_.keyframes()) used.insert(keyframe.calibration_generation);
  for (auto entry = generations_.begin(); entry != generations_.end();) {
    entry = used.count(entry->first) == 0 ? generations_.erase(entry) : std::next(entry);
  }
  generations_[generation_] = {camera_, way_px};
}

void SlidingWindow::solveUnconditioned() {
  if (map_.keyframes().size() < 2) return;
  Segment segment = map_.lastKeyframes(options_.active_keyframes, camera_);
  if (segment.landmarks.empty()) return;
  const Rigid3 pose = newestPose();
  const double inverse_depth = typicalInverseDepthAt(newest(segment), segment);
  Problem problem{&camera_, false, {freeBlock(&segment, camera_)}};
  problem.blocks[0].inverse_depth_prior =
      InverseDepthPrior{told_inverse_depth_, told_inverse_depth_};
  if (!solve(problem, windowSolver()).usable) return;
  keepPoseAndScale(newest(segment), pose, inverse_depth, &segment);
  takeGeneration(&segment);
  map_.update(segment);
}

void SlidingWindow::reseed(const Segment& solution) {
  if (solution.keyframes.size() < 2) return;
  const bool from_before =
      solution.isLensHeld(0) && map_.keyframe(solution.keyframes.front().id) != nullptr;
  const int k = from_before ? 0 : newest(solution);
  const Keyframe* kept = map_.keyframe(solution.keyframes[k].id);
  if (kept == nullptr) return;
  // Over just the points that typicalInverseDepthAt looks at: others would shift the median and,
  // one reseeding after the other, let the scale run away.
  std::vector<std::int64_t> seen;
  for (const Landmark* landmark : landmarksSeenIn(k, solution)) seen.push_back(landmark->track_id);
  Segment known = solution;
  keepPoseAndScale(k, kept->world_from_camera, typicalInverseDepthOf(seen, *kept), &known);
  takeGeneration(&known);
  map_.update(known);
}

double SlidingWindow::typicalInverseDepthOf(const std::vector<std::int64_t>& track_ids,
                                            const Keyframe& keyframe) const {
  return typicalInverseDepthFrom(keyframe.world_from_camera.translation,
                                 map_.worldPoints(track_ids, camera_));
}

std::optional<PointView> SlidingWindow::viewOf(const Map::Point& point, const Track& track) const {
  const auto known = map_.worldPoint(point, camera_);
  if (!known) return std::nullopt;
  const double middle_row = 0.5 * (camera_.height() - 1);
  return PointView{*known, asSeenAtOnce(track.pixel, track.motion, middle_row, map_.lineDelayS()),
                   track.sigma};
}

PoseEstimate SlidingWindow::localize(const TrackedFrame& frame, const Rigid3& guess) const {
  std::vector<PointView> known;
  std::vector<PointView> all;  // also those seen in one keyframe alone, whose depth is a guess
  for (const Track& track : frame.tracks) {
    const auto found = map_.points().find(track.id);
    if (found == map_.points().end()) continue;
    const auto view = viewOf(found->second, track);
    if (!view) continue;
    all.push_back(*view);
    if (found->second.sightings.size() > 1) known.push_back(*view);
  }
  return solvePose(camera_, known.size() >= kEnoughKnownPoints ? known : all, guess);
}

// Among the newest; null if there is none.
const Keyframe* SlidingWindow::keyframeAt(std::int64_t stamp_ns) const {
  const auto& keyframes = map_.keyframes();
  for (auto keyframe = keyframes.rbegin(); keyframe != keyframes.rend(); ++keyframe) {
    if (keyframe->stamp_ns == stamp_ns) return &*keyframe;
    if (keyframe->stamp_ns < stamp_ns) break;
  }
  return nullptr;
}

void SlidingWindow::setMotions(std::int64_t stamp_ns,
                               const std::map<std::int64_t, ImageMotion>& motions) {
  const Keyframe* keyframe = keyframeAt(stamp_ns);
  if (keyframe != nullptr) map_.setMotions(keyframe->id, motions, camera_.height());
}

// Whether the keyframe's pose was estimated with nearly the intrinsics that it was seen with, as
// known now.
bool SlidingWindow::nearTrueCamera(const Keyframe& keyframe) const {
  const auto solved_with = generations_.find(keyframe.calibration_generation);
  if (solved_with == generations_.end()) return false;
  const double limit = options_.max_generation_distance_px;
  const Generation& generation = solved_with->second;
  const Camera& true_camera = map_.cameraOf(keyframe, camera_);
  if (&true_camera == &camera_ &&
      generations_.at(generation_).way_px - generation.way_px <= limit) {
    return true;
  }
  return pixelDistance(generation.camera, true_camera).rms <= limit;
}

int SlidingWindow::conditioningCount() const {
  const auto& keyframes = map_.keyframes();
  const int active_begin =
      std::max(0, static_cast<int>(keyframes.size()) - options_.active_keyframes);
  int count = 0;
  std::uint64_t near_generation = generation_;
  while (count < std::min(active_begin, options_.conditioning_keyframes)) {
    const Keyframe& keyframe = keyframes[active_begin - count - 1];
    if (keyframe.calibration_generation != near_generation) {
      if (!nearTrueCamera(keyframe)) break;
      near_generation = keyframe.calibration_generation;
    }
    ++count;
  }
  return count;
}

// Points that move would pull the poses of the window: they are out before it is solved.
std::vector<std::int64_t> SlidingWindow::tracksAtOdds(const Rigid3& pose,
                                                      const std::vector<Track>& tracks) const {
  std::vector<TrackedPoint> points;
  for (const Track& track : tracks) {
    const auto found = map_.points().find(track.id);
    if (found == map_.points().end()) continue;
    const auto view = viewOf(found->second, track);
    if (view) points.push_back({track.id, *view, found->second.sightings.size() > 1});
  }
  return movingTracks(camera_, pose, points, options_.gross_residual_share * camera_.longerSide());
}

std::vector<std::int64_t> SlidingWindow::addKeyframe(Keyframe keyframe,
                                                     const std::vector<Track>& all_tracks) {
  keyframe.calibration_generation = generation_;
  std::vector<std::int64_t> at_odds;
  if (trusted_) at_odds = tracksAtOdds(keyframe.world_from_camera, all_tracks);
  map_.removePoints(at_odds);
  std::vector<Track> tracks;
  for (const Track& track : all_tracks) {
    if (std::find(at_odds.begin(), at_odds.end(), track.id) == at_odds.end()) {
      tracks.push_back(track);
    }
  }
  // New points start where those are that the same view holds already.
  std::vector<std::int64_t> seen;
  for (const Track& track : tracks) seen.push_back(track.id);
  map_.addKeyframe(keyframe, tracks, typicalInverseDepthOf(seen, keyframe), camera_);
  std::vector<std::int64_t> outliers = solveWindow();
  outliers.insert(outliers.end(), at_odds.begin(), at_odds.end());
  return outliers;
}

void SlidingWindow::rememberInverseDepth(const Segment& segment, int fixed_keyframes) {
  const double inverse_depth = medianInverseDepth(segment, 0.0);
  if (inverse_depth > 0.0 && hasParallax(segment, fixed_keyframes)) {
    told_inverse_depth_ = inverse_depth;
  }
}

// From the window's state; and from one without depths and translations, where that may be of a
// wrong minimum: depths came of noise, or the scene lies behind the camera (eq. 1 is the same for
// the opposite depths and translations). Then older poses that were far enough apart for depths may
// be wrong, too.
bool SlidingWindow::solveActive(const SegmentBlock& block, const SegmentBlock& unconditioned) {
  Segment* segment = block.segment;
  const bool depths_known = block.fixed_landmark < 0;
  // The landmark that holds the scale stays: without translations, none tells more than others.
  SegmentBlock other = depths_known ? unconditioned : block;
  Segment turning = asIfTurning(*segment, other.fixed_keyframes, scaleOf(other));
  const SolveSummary solved = solve({&camera_, false, {block}}, windowSolver());
  if (!solved.usable) return false;
  const bool in_front = medianInverseDepth(*segment, 0.0) > 0.0;
  if (depths_known && in_front) return true;
  if (!hasParallax(*segment, block.fixed_keyframes)) return true;
  other.segment = &turning;
  const SolveSummary again = solve({&camera_, false, {other}}, windowSolver(kFarIterations));
  if (!again.usable || !(medianInverseDepth(turning, 0.0) > 0.0)) return true;
  // Each parameter more that is free explains a half on average.
  const int freed = 6 * std::max(0, block.fixed_keyframes - other.fixed_keyframes);
  const bool better = again.final_cost + freed < kSameMinimum * solved.final_cost;
  if (better || !in_front) *segment = std::move(turning);
  return true;
}

std::vector<std::int64_t> SlidingWindow::solveWindow() {
  std::vector<std::int64_t> outlier_ids;
  if (map_.keyframes().size() < 2) return outlier_ids;
  const int conditioning = conditioningCount();
  Segment segment = map_.lastKeyframes(options_.active_keyframes + conditioning, camera_);
  removeLandmarks(seenByFixedAlone(segment, conditioning), &segment);
  SegmentBlock unconditioned = freeBlock(&segment, camera_);
  unconditioned.inverse_depth_prior = InverseDepthPrior{told_inverse_depth_, told_inverse_depth_};
  SegmentBlock block = unconditioned;
  if (conditioning >= 2) {
    const double baseline = (segment.keyframes[0].world_from_camera.translation -
                             segment.keyframes[conditioning - 1].world_from_camera.translation)
                                .norm();
    const double inverse_depth = typicalInverseDepthAt(newest(segment), segment);
    if (baseline * inverse_depth > kSeparatedPoses) block.fixed_landmark = -1;
    block.fixed_keyframes = conditioning;
  }
  if (!solveActive(block, unconditioned)) return outlier_ids;
  map_.update(segment);
  rememberInverseDepth(segment, conditioning);
  if (!trusted_) return outlier_ids;
  block.sigma_scale = std::max(1.0, medianResidualScale(block, camera_));
  const double min_px = options_.gross_residual_share * camera_.longerSide();
  for (const int l : grossMisfits(block, camera_, kGrossSigmas, min_px)) {
    outlier_ids.push_back(segment.landmarks[l].track_id);
  }
  map_.removePoints(outlier_ids);
  return outlier_ids;
}

}  // namespace camera_self_calibration
