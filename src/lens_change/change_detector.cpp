// The newest window against the queue.

#include "camera_self_calibration/lens_change/change_detector.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/map/segment_edit.h"

namespace camera_self_calibration {
namespace {

using Kind = ChangeVerdict::Kind;

// p-value above which no closer look is worth its time, and a suspicion was for nothing: chance
// alone asks for one window in ten, at the price of a solve each.
constexpr double kClearlySame = 0.1;
constexpr int kMinLaterKeyframes = 3;    // after a suspected onset, to decide
constexpr int kMinEarlierKeyframes = 2;  // before it, for their structure to be of use
// Keyframes by which a suspicion may come too late and too early.
constexpr int kSuspectedLate = 1;
constexpr int kSuspectedEarly = 2;
constexpr int kFindings = 2;  // keyframes in a row that find the same new lens
// Distance between two findings, as a share of the change: nearer to each other than half way back.
constexpr double kSameLens = 0.5;
// Statistic per observation that needs no second finding, as if each were off by one more sigma: no
// wrong minimum is as bad.
constexpr double kBlatant = 1.0;
// Residual scale, over that of the queue's segments, of data that fit no lens.
constexpr double kMaxMisfit = 2.0;

int keyframesBefore(const Segment& window, std::int64_t onset_ns) {
  int count = 0;
  for (const Keyframe& keyframe : window.keyframes) count += keyframe.stamp_ns < onset_ns;
  return count;
}

double usualResidualScale(const SegmentQueue& queue) {
  std::vector<double> scales;
  for (const Candidate& candidate : queue.candidates()) scales.push_back(candidate.residual_scale);
  return std::max(1.0, median(std::move(scales), 1.0));
}

// What a candidate that contradicts says without the tracks that may feign it.
std::optional<QuadraticLikelihood> verified(const QuadraticLikelihood& likelihood,
                                            const Candidate& candidate,
                                            const Reference& reference) {
  const auto fitting = likelihoodAt(
      reference.camera, fittingOneLens(candidate.segment, reference.camera), candidate.sigma_scale);
  const double whole = agreement({likelihood}, reference).statistic;
  return fitting && agreement({*fitting}, reference).statistic < whole ? fitting : likelihood;
}

}  // namespace

std::string ChangeDetector::withP(const char* text, double p_value) {
  return formatted("%s (p = %.1e)", text, p_value);
}

double ChangeDetector::limit() const { return share(interval_s_); }

void ChangeDetector::measureInterval(std::int64_t stamp_ns) {
  if (stamp_ns == last_stamp_ns_) return;
  const double interval = std::clamp(toSeconds(stamp_ns - last_stamp_ns_), 0.02, 2.0);
  if (last_stamp_ns_ > 0) interval_s_ += 0.1 * (interval - interval_s_);
  last_stamp_ns_ = stamp_ns;
}

ChangeVerdict ChangeDetector::examine(const Segment& window, const Candidate& candidate,
                                      std::int64_t suspected_onset_ns, const SegmentQueue& queue) {
  suspected_ = suspected_onset_ns > 0 || (suspected_ && in_doubt_);
  ChangeVerdict verdict = examineKeyframe(window, candidate, suspected_onset_ns, queue);
  if (verdict.kind == Kind::kChange && isRatherDrift(verdict, queue)) verdict.kind = Kind::kDoubt;
  if (verdict.kind != Kind::kChange && hasNews()) {
    ChangeVerdict together = examineCourse(queue);
    if (together.kind != Kind::kSame) verdict = std::move(together);
  }
  const bool by_window = verdict.kind == Kind::kChange && verdict.recent.empty();
  in_doubt_ = verdict.kind != Kind::kSame;
  if (by_window) return confirmed(std::move(verdict), queue.solution().camera);
  findings_ = 0;
  return verdict;
}

std::optional<double> ChangeDetector::clearlySame(const CandidateOutlook& outlook,
                                                  std::int64_t suspected_onset_ns,
                                                  const SegmentQueue& queue) {
  measureInterval(outlook.likelihood.end_ns);
  if (suspected_onset_ns > 0 || in_doubt_ || isNewSegment(outlook.likelihood.begin_ns) ||
      !fitsAsUsual(outlook.sigma_scale, queue)) {
    return std::nullopt;
  }
  const auto reference =
      referenceWithout(outlook.likelihood.begin_ns, outlook.likelihood.end_ns, queue);
  if (!reference) return std::nullopt;
  const double p_value = agreement({outlook.likelihood}, *reference).p_value;
  if (!(p_value > kClearlySame)) return std::nullopt;
  return p_value;
}

ChangeVerdict ChangeDetector::examineUnfinished(const Segment& window, const Candidate& candidate,
                                                const Reference& reference, double residual_scale) {
  measureInterval(window.endNs());
  usual_residual_scale_ = std::max(1.0, residual_scale);
  ChangeVerdict verdict;
  const bool comparable = candidate.information.rows() == reference.information.rows();
  if (comparable && agreement({ownLikelihood(candidate)}, reference).p_value < kClearlySame) {
    verdict = examineWindow(window, 0, reference);
  }
  if (verdict.kind == Kind::kChange) return confirmed(std::move(verdict), reference.camera);
  findings_ = 0;
  return verdict;
}

ChangeVerdict ChangeDetector::confirmed(ChangeVerdict verdict, const Camera& before) {
  const double change = pixelDistance(before, verdict.camera).rms;
  const bool again =
      findings_ > 0 && pixelDistance(found_, verdict.camera).rms < kSameLens * change;
  findings_ = again ? findings_ + 1 : 1;
  found_ = verdict.camera;
  if (findings_ >= kFindings || verdict.excess > kBlatant) return verdict;
  verdict.kind = Kind::kDoubt;
  verdict.reason += ", if the next keyframes say the same";
  return verdict;
}

ChangeVerdict ChangeDetector::examineKeyframe(const Segment& window, const Candidate& candidate,
                                              std::int64_t suspected_onset_ns,
                                              const SegmentQueue& queue) {
  measureInterval(window.endNs());
  usual_residual_scale_ = usualResidualScale(queue);
  ChangeVerdict verdict;
  auto reference = referenceWithout(window.beginNs(), window.endNs(), queue);
  if (!reference || window.keyframes.empty()) return verdict;
  // Where nothing was seen to happen, all that speaks for a change is that segments differ. On real
  // video they do so while nothing changes too, by how much few of them hardly show.
  reference->cautious = !suspected_;
  const int earlier = keyframesBefore(window, suspected_onset_ns);
  if (suspected_onset_ns > 0 && earlier > 0) return examineSuspicion(window, earlier, *reference);
  return examineCandidate(window, candidate, *reference);
}

ChangeVerdict ChangeDetector::examineSuspicion(const Segment& window, int earlier_keyframes,
                                               const Reference& reference) const {
  ChangeVerdict verdict;
  const int later = static_cast<int>(window.keyframes.size()) - earlier_keyframes;
  if (later >= kMinLaterKeyframes && earlier_keyframes >= kMinEarlierKeyframes) {
    verdict = examineWindow(window, earlier_keyframes, reference);
    if (verdict.kind == Kind::kSame && verdict.p_value > kClearlySame) return verdict;
  }
  if (verdict.kind == Kind::kSame) {
    verdict.kind = Kind::kDoubt;
    verdict.reason =
        "the tracks fit less well than usual: the next keyframes will show whether the lens has "
        "changed";
  }
  return verdict;
}

ChangeVerdict ChangeDetector::examineCandidate(const Segment& window, const Candidate& candidate,
                                               const Reference& reference) {
  ChangeVerdict verdict;
  if (candidate.information.size() == 0) return verdict;
  if (candidate.residual_scale > kMaxMisfit * usual_residual_scale_) {
    verdict.kind = Kind::kBadData;
    verdict.reason = "the tracks fit no lens well";
    return verdict;
  }
  const double own_p_value = agreement({ownLikelihood(candidate)}, reference).p_value;
  if (own_p_value > kClearlySame && !isNewSegment(candidate.segment.beginNs())) {
    verdict.p_value = own_p_value;
    return verdict;
  }
  auto likelihood =
      likelihoodAt(reference.camera, restarted(candidate.segment, window), candidate.sigma_scale);
  if (!likelihood) return verdict;
  const bool contradicts = agreement({*likelihood}, reference).p_value < kDoubt;
  if (contradicts) likelihood = verified(*likelihood, candidate, reference);
  if (!recent_.empty() && recent_.back().likelihood.point.size() != likelihood->point.size()) {
    recent_.clear();  // of another lens model
  }
  const Agreement single = agreement({*likelihood}, reference);
  verdict.p_value = single.p_value;
  if (single.p_value < limit()) verdict = examineWindow(window, 0, reference);
  if (verdict.kind != Kind::kBadData) remember(candidate, *likelihood);
  if (verdict.kind == Kind::kSame && contradicts) {
    verdict.kind = Kind::kDoubt;
    verdict.reason = withP("it disagrees with the segments in use", single.p_value);
  }
  return verdict;
}

// The newest window under a change before keyframe `earlier_keyframes`; where it speaks of one,
// under the most likely change.
ChangeVerdict ChangeDetector::examineWindow(const Segment& window, int earlier_keyframes,
                                            const Reference& reference) const {
  ChangeVerdict verdict;
  double allowed = limit();
  // A suspicion is not exact, and a single keyframe on the wrong side hides the change. The best of
  // several dates has as many chances to look like one (Bonferroni).
  if (earlier_keyframes > 0) {
    allowed /= kSuspectedLate + 1 + kSuspectedEarly;
    earlier_keyframes = dateLensChange(window, reference, earlier_keyframes - kSuspectedLate,
                                       earlier_keyframes + kSuspectedEarly);
  }
  LensChange change = testLensChange(window, earlier_keyframes, reference);
  if (change.usable && change.p_value < allowed) {
    const int dated = dateLensChange(window, reference);
    if (dated != earlier_keyframes) change = testLensChange(window, dated, reference);
    earlier_keyframes = dated;
  }
  verdict.p_value = change.usable ? change.p_value : kDoubt;
  if (!change.usable || change.p_value >= kDoubt) return verdict;
  const int later = static_cast<int>(window.keyframes.size()) - earlier_keyframes;
  verdict.kind = Kind::kDoubt;
  verdict.reason = withP("another lens would explain it better", change.p_value);
  if (change.residual_scale > kMaxMisfit * usual_residual_scale_) {
    verdict.kind = Kind::kBadData;
    verdict.reason = "the tracks fit no lens well";
  } else if (change.p_value < allowed && later >= kMinLaterKeyframes) {
    verdict.kind = Kind::kChange;
    verdict.reason = withP("the lens changed", change.p_value);
    verdict.onset_ns = window.keyframes[earlier_keyframes].stamp_ns;
    verdict.camera = change.camera;
    verdict.information = change.information;
    verdict.excess = change.statistic / static_cast<double>(change.segment.observations.size());
    verdict.segment = std::move(change.segment);
  }
  return verdict;
}

}  // namespace camera_self_calibration
