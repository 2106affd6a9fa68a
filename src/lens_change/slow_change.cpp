// All segments together: the part of ChangeDetector that finds what is too small for a single
// window, and what goes on slowly.

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/lens_change/change_detector.h"

namespace camera_self_calibration {
namespace {

using Kind = ChangeVerdict::Kind;

// Segments remembered beside the queue: half a minute to a minute, by when a step of a percent
// shows.
constexpr std::size_t kSegments = 16;
// Newest segments that replace what a drift made stale: a third tells which of two is right.
constexpr std::size_t kFollowed = 3;
// Bayes factor that is strong evidence (Jeffreys, "Theory of probability", 1961): of a step against
// a drift, of a segment that is wrong against all else.
constexpr double kStrong = 10.0;

bool overlap(const Candidate& candidate, const QuadraticLikelihood& likelihood) {
  return candidate.segment.beginNs() <= likelihood.end_ns &&
         candidate.segment.endNs() >= likelihood.begin_ns;
}

std::vector<QuadraticLikelihood> ownLikelihoods(const std::vector<Candidate>& candidates) {
  std::vector<QuadraticLikelihood> own;
  own.reserve(candidates.size());
  for (const Candidate& candidate : candidates) own.push_back(ownLikelihood(candidate));
  return own;
}

// What the segments say without anything else known.
Reference nothingKnown(const Camera& camera) {
  const int count = camera.estimatedCount();
  return {camera, IntrinsicsMatrix::Zero(count, count), Scatter()};
}

// Segments that disagree with what the lens has become.
std::vector<std::int64_t> staleSegments(const Reference& now, const SegmentQueue& queue,
                                        double p_value) {
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
  const std::int64_t since_ns =
      recent_.empty() ? likelihood.begin_ns : recent_.back().likelihood.end_ns;
  course_limit_ = share(toSeconds(likelihood.end_ns - since_ns));
  drift_told_ = false;  // until examineCourse() says so
  recent_.push_back({candidate, likelihood});
  if (recent_.size() > kSegments) recent_.pop_front();
}

bool ChangeDetector::hasNews() const {
  return !recent_.empty() && recent_.back().likelihood.end_ns == last_stamp_ns_;
}

// The queue's, and the newest that fit a lens as well and share no moment with them. Without those
// that end later, by a clock that was set back since: whether they came before or after the others
// nobody knows.
std::vector<QuadraticLikelihood> ChangeDetector::segmentsOf(const SegmentQueue& queue,
                                                            std::int64_t now_ns) const {
  const std::vector<Candidate>& candidates = queue.candidates();
  std::vector<QuadraticLikelihood> segments = ownLikelihoods(candidates);
  for (const RememberedSegment& segment : recent_) {
    const bool fits =
        segment.candidate.well_posed && fitsAsUsual(segment.candidate.sigma_scale, queue);
    const auto shares = [&](const Candidate& one) { return overlap(one, segment.likelihood); };
    if (fits && std::none_of(candidates.begin(), candidates.end(), shares)) {
      segments.push_back(segment.likelihood);
    }
  }
  segments.erase(
      std::remove_if(segments.begin(), segments.end(),
                     [now_ns](const QuadraticLikelihood& one) { return one.end_ns > now_ns; }),
      segments.end());
  return segments;
}

LensDrift ChangeDetector::drift(const SegmentQueue& queue, std::int64_t now_ns) const {
  const Camera& camera = queue.solution().camera;
  const LensCourse course = courseOfLens(segmentsOf(queue, now_ns), camera, now_ns);
  LensDrift drift;
  if (!course.exceeds(1.0)) return drift;
  drift.significant = withEstimated(camera, course.now).valid();
  drift.told = drift_told_;
  drift.rate = course.rate;
  drift.offset = course.now - compromise(ownLikelihoods(queue.candidates()), nothingKnown(camera));
  drift.covariance = course.covariance;
  return drift;
}

std::optional<std::int64_t> ChangeDetector::wrongSegment(const SegmentQueue& queue,
                                                         std::int64_t now_ns) const {
  const LensCourse course =
      courseOfLens(segmentsOf(queue, now_ns), queue.solution().camera, now_ns);
  if (!(course.wrong > std::log(kStrong))) return std::nullopt;
  for (const Candidate& candidate : queue.candidates()) {
    if (candidate.segment.beginNs() == course.wrong_begin_ns) return candidate.segment.sequence;
  }
  return std::nullopt;
}

// With what the newest window says of the lens after the change.
bool ChangeDetector::isRatherDrift(const ChangeVerdict& change, const SegmentQueue& queue) const {
  const auto count = change.information.rows();
  QuadraticLikelihood since{change.onset_ns, change.segment.endNs(),
                            change.camera.parameters().head(count), Intrinsics::Zero(count),
                            change.information};
  std::vector<QuadraticLikelihood> segments{std::move(since)};
  for (QuadraticLikelihood& segment : segmentsOf(queue, last_stamp_ns_)) {
    if (segment.end_ns < change.onset_ns) segments.push_back(std::move(segment));
  }
  const LensCourse course =
      courseOfLens(std::move(segments), queue.solution().camera, last_stamp_ns_);
  return course.drift > course.step;
}

ChangeVerdict ChangeDetector::examineCourse(const SegmentQueue& queue) {
  const Camera& camera = queue.solution().camera;
  const LensCourse course = courseOfLens(segmentsOf(queue, last_stamp_ns_), camera, last_stamp_ns_);
  ChangeVerdict verdict;
  const bool established = course.pValue() < course_limit_ && course.exceeds(1.0 / kDoubt);
  drift_told_ = established && course.drift > course.step;
  if (!established) return verdict;
  verdict.p_value = course.pValue();
  verdict.onset_ns = course.onset_ns;
  verdict.segment = recent_.back().candidate.segment;
  if (course.step > course.drift + std::log(kStrong)) {
    describeStep(queue, &verdict);
  } else if (drift_told_) {
    describeDrift(course, queue, &verdict);
  }
  return verdict;
}

// What was seen since the step, in all intrinsics.
void ChangeDetector::describeStep(const SegmentQueue& queue, ChangeVerdict* verdict) const {
  const Camera& camera = queue.solution().camera;
  std::vector<QuadraticLikelihood> since;
  verdict->information = nothingKnown(camera).information;
  for (const QuadraticLikelihood& segment : segmentsOf(queue, last_stamp_ns_)) {
    if (segment.point.size() != camera.estimatedCount() || segment.begin_ns < verdict->onset_ns)
      continue;
    since.push_back(segment);
    verdict->information += segment.information;
  }
  verdict->camera = withEstimated(camera, compromise(since, nothingKnown(camera)));
  if (!verdict->camera.valid()) return;
  const auto keep = [&](const Candidate& candidate) {
    if (candidate.well_posed && candidate.segment.beginNs() >= verdict->onset_ns) {
      verdict->recent.push_back(candidate);
    }
  };
  for (const Candidate& candidate : queue.candidates()) keep(candidate);
  for (const RememberedSegment& segment : recent_) keep(segment.candidate);
  verdict->kind = Kind::kChange;
  verdict->reason = withP("the lens changed", verdict->p_value);
}

void ChangeDetector::describeDrift(const LensCourse& course, const SegmentQueue& queue,
                                   ChangeVerdict* verdict) const {
  verdict->camera = withEstimated(queue.solution().camera, course.now);
  const auto information = covarianceFromInformation(course.covariance);
  if (!verdict->camera.valid() || !information) return;
  verdict->information = *information;
  verdict->stale = staleSegments({verdict->camera, *information, Scatter()}, queue, kDoubt);
  for (std::size_t i = recent_.size() - std::min(kFollowed, recent_.size()); i < recent_.size();
       ++i) {
    if (recent_[i].candidate.well_posed) verdict->recent.push_back(recent_[i].candidate);
  }
  verdict->kind = Kind::kDrift;
  verdict->reason = withP("the lens drifts slowly", verdict->p_value);
}

}  // namespace camera_self_calibration
