#include "camera_self_calibration/rig/mount_watch.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "camera_self_calibration/base/stamp.h"

namespace camera_self_calibration {
namespace {

// Keyframes that tell something: landmarks take three views, and a way.
constexpr std::size_t kMinFrames = 5;

bool sameModels(const Rig& a, const Rig& b) {
  const auto same = [](const Camera& one, const Camera& other) {
    return one.estimatesSameAs(other);
  };
  return std::equal(a.cameras.begin(), a.cameras.end(), b.cameras.begin(), b.cameras.end(), same);
}

}  // namespace

void MountWatch::add(const RigFrame& frame) {
  const RigView& first = frame.views.front();
  if (!first.world_from_camera) return;
  const bool back = !newest_.empty() && frame.stamp_ns <= newest_.back().stamp_ns;
  if (back || (!newest_.empty() && newest_.back().views.front().map_id != first.map_id)) {
    closeSegment();
  }
  forgetAround(frame.stamp_ns);
  newest_.push_back(frame);
  if (static_cast<int>(newest_.size()) >= options_.mount_frames) closeSegment();
}

// Nothing is counted twice.
void MountWatch::forgetAround(std::int64_t stamp_ns) {
  const auto told = [&](const RigLikelihood& segment) {
    return segment.begin_ns <= stamp_ns && stamp_ns <= segment.end_ns;
  };
  const auto waits = [&](const RigFrames& frames) {
    return frames.front().stamp_ns <= stamp_ns && stamp_ns <= frames.back().stamp_ns;
  };
  segments_.erase(std::remove_if(segments_.begin(), segments_.end(), told), segments_.end());
  waiting_.erase(std::remove_if(waiting_.begin(), waiting_.end(), waits), waiting_.end());
}

void MountWatch::closeSegment() {
  if (newestTells()) waiting_.push_back(std::move(newest_));
  newest_.clear();
  if (waiting_.size() > kMaxWaiting) waiting_.pop_front();
}

std::deque<RigFrames> MountWatch::takeWaiting() {
  return std::exchange(waiting_, std::deque<RigFrames>());
}

bool MountWatch::newestTells() const { return newest_.size() >= kMinFrames; }

std::optional<RigLikelihood> MountWatch::likelihood(const RigFrames& frames,
                                                    const RigOptions& options,
                                                    const FindAcross& across, const Rig& known,
                                                    double inverse_depth) {
  RigOptions own = options;
  own.segment_frames = static_cast<int>(frames.size());
  own.min_frames = static_cast<int>(std::min(kMinFrames, frames.size()));
  own.max_frames = own.segment_frames;
  RigCalibrator calibrator(own, known.size(), across);
  for (const RigFrame& frame : frames) calibrator.add(frame);
  return calibrator.likelihood(known, inverse_depth);
}

void MountWatch::learn(RigLikelihood segment) {
  if (!segments_.empty() && !sameModels(segments_.back().rig, segment.rig)) segments_.clear();
  segments_.push_back(std::move(segment));
  if (segments_.size() > kMaxSegments) segments_.pop_front();
}

MountVerdict MountWatch::judge(const std::optional<RigLikelihood>& newest, const Rig& reference) {
  std::vector<RigLikelihood> all(segments_.begin(), segments_.end());
  if (newest) all.push_back(*newest);
  const auto fits = [&](const RigLikelihood& segment) {
    return sameModels(segment.rig, all.back().rig);
  };
  if (!std::all_of(all.begin(), all.end(), fits) || all.empty()) return {};
  const std::int64_t begin_ns = asked_ns_.value_or(all.front().begin_ns);
  const double hours = toSeconds(std::max<std::int64_t>(0, all.back().end_ns - begin_ns)) / 3600.0;
  asked_ns_ = all.back().end_ns;
  MountVerdict verdict = judgeMounts(all, reference, options_.false_alarms_per_hour * hours);
  const auto at =
      segments_.begin() + static_cast<std::ptrdiff_t>(std::min(verdict.index, segments_.size()));
  if (verdict.kind == MountVerdict::Kind::kChange) segments_.erase(segments_.begin(), at);
  if (verdict.kind == MountVerdict::Kind::kOutlier && at != segments_.end()) {
    segments_.erase(at);
  }
  return verdict;
}

void MountWatch::clear() {
  newest_.clear();
  waiting_.clear();
  segments_.clear();
}

}  // namespace camera_self_calibration
