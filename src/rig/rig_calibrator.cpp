#include "camera_self_calibration/rig/rig_calibrator.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numeric>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/estimation/gate.h"
#include "camera_self_calibration/estimation/transfer.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/map/inverse_depth.h"
#include "camera_self_calibration/rig/hand_eye.h"

namespace camera_self_calibration {
namespace {

// A start that is off by more leads nowhere.
constexpr double kMaxStartSigma = 5.0 * kDegree;
constexpr double kBorder = 12.0;  // [px] What a patch needs around it.
constexpr double kStep = 2.0;     // [px] For the warp from one image to the other.
constexpr std::size_t kMaxRotations = 5000;
constexpr int kRounds = 2;  // of seeking landmarks across cameras
// RigSolveOptions::tolerance of all solutions but the last.
constexpr double kRoughTolerance = 1e-4;

// Where another camera sees what one camera sees along a ray, at an inverse distance.
struct AcrossView {
  const Rig& rig;
  int from;
  int to;

  std::optional<Eigen::Vector2d> operator()(const Eigen::Vector2d& pixel, double inverse) const {
    const auto ray = rig.cameras[from].unproject(pixel);
    if (!ray) return std::nullopt;
    const Rigid3 to_from = rig.rig_from_camera[to].inverse() * rig.rig_from_camera[from];
    Eigen::Vector2d seen;
    if (!rig.cameras[to].project(to_from.rotation * *ray + inverse * to_from.translation, &seen)) {
      return std::nullopt;
    }
    return seen;
  }
};

std::optional<ExpectedAcross> expect(const AcrossView& view, const Observation& seen,
                                     double inverse_depth) {
  ExpectedAcross expected;
  const auto here = view(seen.pixel, inverse_depth);
  const auto right = view(seen.pixel + Eigen::Vector2d(kStep, 0.0), inverse_depth);
  const auto below = view(seen.pixel + Eigen::Vector2d(0.0, kStep), inverse_depth);
  const auto nearer = view(seen.pixel, 1.1 * inverse_depth);
  if (!here || !right || !below || !nearer) return std::nullopt;
  if (!view.rig.cameras[view.to].inImage(*here, kBorder)) return std::nullopt;
  expected.pixel = seen.pixel;
  expected.sigma = seen.sigma;
  expected.there.pixel = *here;
  expected.there.linear.col(0) = (*right - *here) / kStep;
  expected.there.linear.col(1) = (*below - *here) / kStep;
  const Eigen::Vector2d along = *nearer - *here;
  if (along.norm() > 1e-9) expected.along = along.normalized();
  return expected;
}

// Removes views of other cameras that lie off by more than the others do.
void dropGrossAcross(RigSegment* segment) {
  constexpr double kGross = 4.8;  // sigmas: one in 10^5 of two dimensions
  const RigViews views{static_cast<int>(segment->tracks.size())};
  for (int c = 0; c < views.cameras; ++c) {
    Segment& tracks = segment->tracks[c];
    std::vector<double> norms(tracks.observations.size(), 0.0);
    std::vector<double> across;
    Transfers transfers;
    predictObservations(tracks, tracks.held_lenses[c], &transfers,
                        [&](std::size_t o, const Eigen::Vector2d* pixel) {
                          const Observation& seen = tracks.observations[o];
                          if (views.camera(seen.keyframe) == c) return;
                          norms[o] = pixel ? (seen.pixel - *pixel).norm() / seen.sigma : 1e9;
                          across.push_back(norms[o]);
                        });
    if (across.empty()) continue;
    std::nth_element(across.begin(), across.begin() + across.size() / 2, across.end());
    const double scale = std::max(1.0, across[across.size() / 2] / 1.177);  // median of Rayleigh
    std::vector<Observation> kept;
    for (std::size_t o = 0; o < norms.size(); ++o) {
      if (norms[o] <= kGross * scale) kept.push_back(tracks.observations[o]);
    }
    tracks.observations = std::move(kept);
  }
}

// The tracks of one camera for whatever looks at them as at those of a camera alone. The rig's
// poses are shared among its cameras.
SegmentBlock blockOf(RigSegment* segment, int camera) {
  const auto cameras = static_cast<int>(segment->tracks.size());
  SegmentBlock block;
  block.segment = &segment->tracks[camera];
  block.fixed_keyframes = segment->frames() * cameras - std::max(1, segment->frames() / cameras);
  return block;
}

// Whether the tracker's sigmas, or else what is left anyway, explain the residuals of `other` too,
// but for chance.
bool explainsAsWell(const SegmentBlock& other, const SegmentBlock& own, const Camera& camera) {
  const auto count = static_cast<double>(own.segment->observations.size());
  const double allowed = std::max(1.0, medianResidualScale(own, camera));
  return count == 0.0 ||
         medianResidualScale(other, camera) <= allowed * (1.0 + 3.0 / std::sqrt(count));
}

// What the motion between neighbours tells of a rotation about the axis that it tells least: sum of
// `|w|^2 I - w w^T`, w the rotation vectors [rad^2].
double leastTurn(const RigFrames& frames) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (std::size_t f = 1; f < frames.size(); ++f) {
    const Eigen::Vector3d w =
        logSo3(frames[f - 1].views.front().world_from_camera->rotation.conjugate() *
               frames[f].views.front().world_from_camera->rotation);
    information += w.squaredNorm() * Eigen::Matrix3d::Identity() - w * w.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(information).eigenvalues()(0);
}

}  // namespace

RigCalibrator::RigCalibrator(RigOptions options, int cameras, FindAcross across)
    : options_(std::move(options)),
      across_(std::move(across)),
      rotations_(static_cast<std::size_t>(cameras)) {}

void RigCalibrator::add(RigFrame frame) {
  const RigView& first = frame.views.front();
  if (!first.world_from_camera) return;
  forgetAround(frame.stamp_ns);
  if (collected_.empty() || static_cast<int>(collected_.back().size()) >= options_.segment_frames ||
      collected_.back().back().views.front().map_id != first.map_id) {
    collected_.emplace_back();
  }
  collected_.back().push_back(std::move(frame));
  if (frames() <= options_.max_frames || collected_.size() < 2) return;
  const auto turns_less = [](const RigFrames& a, const RigFrames& b) {
    return leastTurn(a) < leastTurn(b);
  };
  collected_.erase(std::min_element(collected_.begin(), collected_.end() - 1, turns_less));
}

// Nothing is counted twice.
void RigCalibrator::forgetAround(std::int64_t stamp_ns) {
  const auto again = [&](const RigFrames& frames) {
    return frames.front().stamp_ns <= stamp_ns && stamp_ns <= frames.back().stamp_ns;
  };
  collected_.erase(std::remove_if(collected_.begin(), collected_.end(), again), collected_.end());
}

// In the order in which they came: where time jumped back, what came before the jump is older.
void RigCalibrator::forgetBefore(std::int64_t stamp_ns) {
  std::int64_t next_ns = std::numeric_limits<std::int64_t>::max();
  bool older = false;
  for (auto frames = collected_.rbegin(); frames != collected_.rend(); ++frames) {
    auto frame = frames->end();
    while (!older && frame != frames->begin()) {
      const std::int64_t own_ns = std::prev(frame)->stamp_ns;
      older = own_ns < stamp_ns || own_ns >= next_ns;
      if (older) break;
      next_ns = own_ns;
      --frame;
    }
    frames->erase(frames->begin(), frame);
  }
  dropEmpty();
  for (std::deque<RotationPair>& rotations : rotations_) {
    while (!rotations.empty() && rotations.front().stamp_ns < stamp_ns) rotations.pop_front();
  }
}

void RigCalibrator::forget(std::int64_t begin_ns, std::int64_t end_ns) {
  const auto between = [&](const RigFrame& frame) {
    return begin_ns <= frame.stamp_ns && frame.stamp_ns <= end_ns;
  };
  for (RigFrames& frames : collected_) {
    frames.erase(std::remove_if(frames.begin(), frames.end(), between), frames.end());
  }
  dropEmpty();
}

void RigCalibrator::dropEmpty() {
  const auto empty = [](const RigFrames& frames) { return frames.empty(); };
  collected_.erase(std::remove_if(collected_.begin(), collected_.end(), empty), collected_.end());
}

void RigCalibrator::observe(const RigFrame& frame) {
  const RigView& first = frame.views.front();
  if (!first.world_from_camera) return;
  for (std::size_t c = 1; c < frame.views.size(); ++c) {
    const RigView& view = frame.views[c];
    if (!view.world_from_camera) continue;
    std::deque<RotationPair>& rotations = rotations_[c];
    if (!rotations.empty() && frame.stamp_ns <= rotations.back().stamp_ns) rotations.clear();
    // The newest are enough, and bound the memory.
    if (rotations.size() >= kMaxRotations) rotations.pop_front();
    rotations.push_back({frame.stamp_ns, first.map_id, view.map_id,
                         first.world_from_camera->rotation, view.world_from_camera->rotation});
  }
}

void RigCalibrator::compareClocks(RigEstimate* estimate) const {
  for (int c = 1; c < rig_.size(); ++c) {
    estimate->places[c].time_offset = timeOffset({rotations_[c].begin(), rotations_[c].end()});
  }
}

int RigCalibrator::frames() const {
  return std::accumulate(
      collected_.begin(), collected_.end(), 0,
      [](int sum, const RigFrames& frames) { return sum + static_cast<int>(frames.size()); });
}

// Empty, or why there is none.
std::string RigCalibrator::start() {
  std::vector<RigFrame> all;
  for (const RigFrames& frames : collected_) all.insert(all.end(), frames.begin(), frames.end());
  for (int c = 1; c < rig_.size(); ++c) {
    const HandEye found = handEye(motionPairs(all, c, options_.motion_interval_s));
    if (!(found.rotation_sigma <= kMaxStartSigma)) {
      return formatted(
          "the motion does not tell how camera %d is turned against camera 0: turn the rig about "
          "two axes at least",
          c);
    }
    rig_.rig_from_camera[c] = {found.rotation, found.position};
  }
  return {};
}

void RigCalibrator::makeSegments() {
  segments_.clear();
  used_.clear();
  for (const RigFrames& frames : collected_) {
    if (static_cast<int>(frames.size()) < options_.min_frames) continue;
    used_.push_back(frames);
    segments_.push_back(makeRigSegment(frames, rig_));
  }
  alignScales();
}

// The start holds in the scale of the map with most frames; what lies around is about as far in
// all.
void RigCalibrator::alignScales() {
  const auto map_of = [](const RigFrames& frames) { return frames.front().views.front().map_id; };
  std::map<std::uint64_t, std::size_t> counts;
  for (const RigFrames& frames : used_) counts[map_of(frames)] += frames.size();
  const auto fewer = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto most = std::max_element(counts.begin(), counts.end(), fewer);
  std::map<std::uint64_t, std::vector<double>> inverse_depths;
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    std::vector<double>& of_map = inverse_depths[map_of(used_[s])];
    const std::vector<double> more = inverseDepths(segments_[s].tracks.front());
    of_map.insert(of_map.end(), more.begin(), more.end());
  }
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    const std::uint64_t map = map_of(used_[s]);
    if (map == most->first) continue;
    scaleSegment(
        typicalInverseDepth(inverse_depths[map]) / typicalInverseDepth(inverse_depths[most->first]),
        &segments_[s]);
  }
}

// Where `to` should see the landmarks that `from` sees in a frame.
std::vector<ExpectedAcross> RigCalibrator::expectedIn(const RigSegment& segment, int frame,
                                                      int from, int to) const {
  std::vector<ExpectedAcross> expected;
  const Segment& tracks = segment.tracks[from];
  const int view = RigViews{rig_.size()}.index(frame, from);
  for (const Observation& seen : tracks.observations) {
    if (seen.keyframe != view) continue;
    const Landmark& landmark = tracks.landmarks[seen.landmark];
    const double inverse_depth = transferInverseDepth(
        tracks.keyframes[landmark.reference].world_from_camera, landmark.bearing,
        landmark.inverse_depth, tracks.keyframes[view].world_from_camera);
    const auto there = expect({rig_, from, to}, seen, inverse_depth);
    if (!there) continue;
    expected.push_back(*there);
    expected.back().track_id = landmark.track_id;
  }
  return expected;
}

std::vector<SeenAcross> RigCalibrator::seekIn(const RigFrames& frames,
                                              const RigSegment& segment) const {
  std::vector<SeenAcross> found;
  for (int f = 0; f < segment.frames(); ++f) {
    for (int from = 0; from < rig_.size(); ++from) {
      for (int to = 0; to < rig_.size(); ++to) {
        if (to == from) continue;
        for (SeenAcross& one : across_(frames[f], from, to, expectedIn(segment, f, from, to))) {
          one.frame = f;
          found.push_back(one);
        }
      }
    }
  }
  return found;
}

void RigCalibrator::seekAcross() {
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    removeSeenAcross(&segments_[s]);
    addSeenAcross(seekIn(used_[s], segments_[s]), &segments_[s]);
  }
}

bool RigCalibrator::solve() { return solveRig(options_.solve, &segments_, &rig_); }

// Before gates and searches: which features do not fit shows well before the solution has settled.
bool RigCalibrator::solveRoughly() {
  RigSolveOptions rough = options_.solve;
  rough.tolerance = std::max(rough.tolerance, kRoughTolerance);
  return solveRig(rough, &segments_, &rig_);
}

// What other lens models say of the rig, if these explain the tracks as well. However far off they
// are: video that does not tell one from the other tells the rig no better.
std::optional<Rig> RigCalibrator::underOtherLenses() const {
  Rig other = rig_;
  std::vector<RigSegment> segments = segments_;
  for (int c = 0; c < rig_.size(); ++c) {
    if (held(options_.solve, c)) continue;
    const bool radtan = rig_.cameras[c].model() == CameraModel::kRadtan;
    const auto fit =
        fitCamera(rig_.cameras[c], radtan ? CameraModel::kEquidistant : CameraModel::kRadtan);
    if (!fit) return std::nullopt;
    other.cameras[c] = fit->camera;
    other.cameras[c].setEstimateK3(!radtan);
  }
  RigSolveOptions rough = options_.solve;
  rough.tolerance = std::max(rough.tolerance, kRoughTolerance);
  if (!solveRig(rough, &segments, &other)) return std::nullopt;
  std::vector<RigSegment> own = segments_;
  for (int c = 0; c < rig_.size(); ++c) {
    for (std::size_t s = 0; s < segments.size(); ++s) {
      if (!explainsAsWell(blockOf(&segments[s], c), blockOf(&own[s], c), rig_.cameras[c])) {
        return std::nullopt;
      }
    }
  }
  return other;
}

void RigCalibrator::gate() {
  for (RigSegment& segment : segments_) {
    dropGrossAcross(&segment);
    for (int c = 0; c < rig_.size(); ++c) gateSegment(blockOf(&segment, c), rig_.cameras[c]);
  }
}

// From where the segments are. Empty, or why it failed.
std::string RigCalibrator::refine() {
  if (!solveRoughly()) return "too few features were followed in all cameras at once";
  gate();
  for (int round = 0; across_ && round < kRounds; ++round) {
    if (!solveRoughly()) break;
    seekAcross();
    if (!solveRoughly()) break;
    gate();
  }
  return solve() ? "" : "no poses of the cameras explain all tracks together";
}

void RigCalibrator::addShared(RigEvidence* evidence) const {
  std::map<std::int64_t, int> counts;  // of shared views, by stamp
  for (const RigSegment& segment : segments_) {
    for (const SharedView& view : sharedViews(segment)) {
      evidence->shared.push_back(view);
      ++counts[view.stamp_ns];
    }
  }
  if (counts.empty()) return;
  const auto fewer = [](const auto& a, const auto& b) { return a.second < b.second; };
  evidence->example_ns = std::max_element(counts.begin(), counts.end(), fewer)->first;
  for (const RigFrames& frames : used_) {
    for (const RigFrame& frame : frames) {
      if (frame.stamp_ns != evidence->example_ns) continue;
      for (const RigView& view : frame.views) evidence->example.push_back(view.image);
    }
  }
}

RigEstimate RigCalibrator::estimate(std::vector<Camera> cameras) {
  rig_.rig_from_camera.assign(cameras.size(), Rigid3());
  rig_.cameras = std::move(cameras);
  RigEstimate failed;
  failed.sentence = start();
  if (!failed.sentence.empty()) return failed;
  const Rig before = rig_;
  makeSegments();
  failed.sentence = refine();
  if (!failed.sentence.empty()) return failed;
  const auto covariance = rigCovariance(options_.solve, &segments_, &rig_);
  if (!covariance) {
    failed.sentence = "motion and features do not tell the rig";
    return failed;
  }
  auto evidence = std::make_shared<RigEvidence>();
  evidence->before = before;
  evidence->features = featuresOf(rig_, segments_);
  addShared(evidence.get());
  RigEstimate estimate =
      describeRig(rig_, RigLayout(rig_, options_.solve), *covariance, underOtherLenses(),
                  options_.baseline_m, evidence->features, &segments_);
  estimate.evidence = std::move(evidence);
  compareClocks(&estimate);
  judgeRig(&estimate);
  return estimate;
}

// The scale of the keyframes' map is such that what lies around is as far away as usual.
std::optional<RigLikelihood> RigCalibrator::likelihood(const Rig& start, double inverse_depth) {
  rig_ = start;
  options_.solve.hold_intrinsics.assign(start.cameras.size(), true);
  makeSegments();
  if (segments_.empty()) return std::nullopt;
  const double scale =
      inverse_depth / typicalInverseDepth(inverseDepths(segments_.front().tracks.front()));
  for (Rigid3& pose : rig_.rig_from_camera) pose.translation *= scale;
  makeSegments();
  if (!refine().empty()) return std::nullopt;
  return rigLikelihood(options_.solve, &segments_, rig_);
}

}  // namespace camera_self_calibration
