// Disjoint segments together against the queue: the part of ChangeDetector that finds what is too
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

constexpr std::size_t kSegments = 16;
constexpr std::size_t kPools[] = {2, 4, 8};
constexpr std::size_t kFollowed = 3;  // newest segments that replace what a drift made stale

// Segments that disagree with what the lens has become at `p_value` or below.
std::vector<std::int64_t> staleSegments(const ChangeCourse& course, const SegmentQueue& queue,
                                        double p_value) {
  const Reference now{course.camera, course.information, Scatter()};
  std::vector<std::int64_t> stale;
  for (const Candidate& candidate : queue.candidates()) {
    const auto said = likelihoodAt(now.camera, candidate.segment, candidate.sigma_scale);
    if (!said || agreement({*said}, now).p_value < p_value) {
      stale.push_back(candidate.segment.sequence);
    }
  }
  return stale;
}

}  // namespace

bool ChangeDetector::isNewSegment(std::int64_t begin_ns) const {
  return recent_.empty() || begin_ns > recent_.back().likelihood.end_ns;
}

void ChangeDetector::remember(const Candidate& candidate, const QuadraticLikelihood& likelihood) {
  if (!isNewSegment(candidate.segment.beginNs())) return;
  recent_.push_back({candidate, likelihood});
  if (recent_.size() > kSegments) recent_.pop_front();
}

std::vector<QuadraticLikelihood> ChangeDetector::segmentsBeside(const SegmentQueue& queue) const {
  std::vector<QuadraticLikelihood> beside;
  for (const RememberedSegment& segment : recent_) {
    const QuadraticLikelihood& likelihood = segment.likelihood;
    const auto shares = [&](const Candidate& candidate) {
      return candidate.segment.beginNs() <= likelihood.end_ns &&
             candidate.segment.endNs() >= likelihood.begin_ns;
    };
    const auto& candidates = queue.candidates();
    const bool fits =
        segment.candidate.well_posed && fitsAsUsual(segment.candidate.sigma_scale, queue);
    if (fits && std::none_of(candidates.begin(), candidates.end(), shares)) {
      beside.push_back(likelihood);
    }
  }
  return beside;
}

// Those of the queue and those beside it.
std::vector<QuadraticLikelihood> ChangeDetector::allSegments(const SegmentQueue& queue) const {
  std::vector<QuadraticLikelihood> segments = segmentsBeside(queue);
  for (const Candidate& candidate : queue.candidates())
    segments.push_back(ownLikelihood(candidate));
  return segments;
}

ChangeVerdict ChangeDetector::examineRecent(const SegmentQueue& queue) const {
  ChangeVerdict doubt;
  for (const std::size_t count : kPools) {
    if (recent_.size() < count) break;
    std::vector<QuadraticLikelihood> pool;
    for (std::size_t i = recent_.size() - count; i < recent_.size(); ++i) {
      pool.push_back(recent_[i].likelihood);
    }
    const auto reference = referenceWithout(pool.front().begin_ns, pool.back().end_ns, queue);
    if (!reference) break;
    const double p_value = agreement(pool, *reference).p_value;
    if (p_value < limit()) return explain(*reference, p_value, queue);
    if (p_value < kDoubt && doubt.kind == Kind::kSame) {
      doubt.kind = Kind::kDoubt;
      doubt.p_value = p_value;
      doubt.reason = withP("the newest segments disagree with the queue", p_value);
    }
  }
  return doubt;
}

ChangeVerdict ChangeDetector::examineStep(const SegmentQueue& queue) const {
  ChangeVerdict verdict;
  const auto step =
      estimateStep(allSegments(queue), queue.solution().camera, last_stamp_ns_, limit());
  if (!step || recent_.empty() || recent_.back().likelihood.begin_ns < step->onset_ns)
    return verdict;
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
  for (const RememberedSegment& segment : recent_) keep(segment.candidate);
  return verdict;
}

ChangeVerdict ChangeDetector::explain(const Reference& reference, double p_value,
                                      const SegmentQueue& queue) const {
  std::vector<QuadraticLikelihood> segments;
  for (const RememberedSegment& segment : recent_) segments.push_back(segment.likelihood);
  const ChangeCourse course = courseOfChange(segments, reference);
  ChangeVerdict verdict;
  verdict.p_value = p_value;
  const bool gradual = course.gradual || queue.solution().drift.significant ||
                       showsDrift(allSegments(queue), queue.solution().camera, last_stamp_ns_);
  verdict.reason = withP(gradual ? "the lens drifts slowly" : "the lens changed", p_value);
  verdict.kind = !course.camera.valid() ? Kind::kDoubt : gradual ? Kind::kDrift : Kind::kChange;
  verdict.onset_ns = segments[course.first].begin_ns;
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
