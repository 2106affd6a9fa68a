// Disjoint stretches together against the queue: the part of ChangeDetector that finds what is too
// small for a single window.

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "camera_self_calibration/lens_change/change_course.h"
#include "camera_self_calibration/lens_change/change_detector.h"
#include "camera_self_calibration/lens_change/lens_step.h"

namespace camera_self_calibration {
namespace {

using Kind = ChangeVerdict::Kind;

constexpr std::size_t kStretches = 16;
constexpr std::size_t kPools[] = {2, 4, 8};
constexpr std::size_t kFollowed = 3;  // newest stretches that replace what a drift made stale

// Segments that disagree with what the lens has become at `p_value` or below.
std::vector<std::int64_t> staleSegments(const ChangeCourse& course, const SegmentQueue& queue,
                                        double p_value) {
  const Reference now{course.camera, course.information, Scatter()};
  std::vector<std::int64_t> stale;
  for (const Candidate& candidate : queue.candidates()) {
    const auto said = evidenceAt(now.camera, candidate.segment, candidate.sigma_scale);
    if (!said || agreement({*said}, now).p_value < p_value) {
      stale.push_back(candidate.segment.sequence);
    }
  }
  return stale;
}

}  // namespace

bool ChangeDetector::isNewStretch(std::int64_t begin_ns) const {
  return recent_.empty() || begin_ns > recent_.back().evidence.end_ns;
}

void ChangeDetector::remember(const Candidate& candidate, const Evidence& evidence) {
  if (!isNewStretch(candidate.segment.beginNs())) return;
  recent_.push_back({candidate, evidence});
  if (recent_.size() > kStretches) recent_.pop_front();
}

std::vector<Evidence> ChangeDetector::stretchesBeside(const SegmentQueue& queue) const {
  std::vector<Evidence> beside;
  for (const Stretch& stretch : recent_) {
    const Evidence& evidence = stretch.evidence;
    const auto shares = [&](const Candidate& candidate) {
      return candidate.segment.beginNs() <= evidence.end_ns &&
             candidate.segment.endNs() >= evidence.begin_ns;
    };
    const auto& candidates = queue.candidates();
    const bool fits =
        stretch.candidate.well_posed && fitsAsUsual(stretch.candidate.sigma_scale, queue);
    if (fits && std::none_of(candidates.begin(), candidates.end(), shares)) {
      beside.push_back(evidence);
    }
  }
  return beside;
}

// Those of the queue and those beside it.
std::vector<Evidence> ChangeDetector::allStretches(const SegmentQueue& queue) const {
  std::vector<Evidence> stretches = stretchesBeside(queue);
  for (const Candidate& candidate : queue.candidates()) stretches.push_back(ownEvidence(candidate));
  return stretches;
}

ChangeVerdict ChangeDetector::examineRecent(const SegmentQueue& queue) const {
  ChangeVerdict doubt;
  for (const std::size_t count : kPools) {
    if (recent_.size() < count) break;
    std::vector<Evidence> pool;
    for (std::size_t i = recent_.size() - count; i < recent_.size(); ++i) {
      pool.push_back(recent_[i].evidence);
    }
    const auto reference = referenceWithout(pool.front().begin_ns, pool.back().end_ns, queue);
    if (!reference) break;
    const double p_value = agreement(pool, *reference).p_value;
    if (p_value < limit()) return explain(*reference, p_value, queue);
    if (p_value < kDoubt && doubt.kind == Kind::kSame) {
      doubt.kind = Kind::kDoubt;
      doubt.p_value = p_value;
      doubt.reason = withP("the newest stretches disagree with the queue", p_value);
    }
  }
  return doubt;
}

ChangeVerdict ChangeDetector::examineStep(const SegmentQueue& queue) const {
  ChangeVerdict verdict;
  const auto step =
      estimateStep(allStretches(queue), queue.solution().camera, last_stamp_ns_, limit());
  if (!step || recent_.empty() || recent_.back().evidence.begin_ns < step->onset_ns) return verdict;
  verdict.kind = Kind::kChange;
  verdict.reason = withP("the lens changed, in one step", step->p_value);
  verdict.p_value = step->p_value;
  verdict.onset_ns = step->onset_ns;
  verdict.camera = step->camera;
  verdict.information = step->information;
  verdict.segment = recent_.back().candidate.segment;
  const auto keep = [&](const Candidate& candidate) {
    if (candidate.well_posed && candidate.segment.beginNs() >= step->onset_ns) {
      verdict.recent.push_back(candidate);
    }
  };
  for (const Candidate& candidate : queue.candidates()) keep(candidate);
  for (const Stretch& stretch : recent_) keep(stretch.candidate);
  return verdict;
}

ChangeVerdict ChangeDetector::explain(const Reference& reference, double p_value,
                                      const SegmentQueue& queue) const {
  std::vector<Evidence> stretches;
  for (const Stretch& stretch : recent_) stretches.push_back(stretch.evidence);
  const ChangeCourse course = courseOfChange(stretches, reference);
  ChangeVerdict verdict;
  verdict.p_value = p_value;
  const bool gradual = course.gradual || queue.solution().drift.significant ||
                       showsDrift(allStretches(queue), queue.solution().camera, last_stamp_ns_);
  verdict.reason = withP(gradual ? "the lens drifts slowly" : "the lens changed", p_value);
  verdict.kind = !course.camera.valid() ? Kind::kDoubt : gradual ? Kind::kDrift : Kind::kChange;
  verdict.onset_ns = stretches[course.first].begin_ns;
  verdict.camera = course.camera;
  verdict.information = course.information;
  verdict.segment = recent_.back().candidate.segment;
  const std::size_t newest = recent_.size() - std::min(kFollowed, recent_.size());
  for (std::size_t i = gradual ? std::max(newest, course.first) : course.first; i < recent_.size();
       ++i) {
    if (recent_[i].candidate.well_posed) verdict.recent.push_back(recent_[i].candidate);
  }
  if (verdict.kind == Kind::kDrift) verdict.stale = staleSegments(course, queue, kDoubt);
  return verdict;
}

}  // namespace camera_self_calibration
