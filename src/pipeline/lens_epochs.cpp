// What the watch over the lens leads to: the part of BackEnd that begins epochs.

#include <optional>
#include <string>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/pipeline/back_end.h"
#include "camera_self_calibration/queue/candidate_outlook.h"

namespace camera_self_calibration {
namespace {

// The batch does not allow for errors that are correlated along tracks: its sigma counts as so many
// times as large.
constexpr double kStartupSigmas = 2.0;
constexpr std::size_t kStartupCourse = 20;  // keyframes
// Times the limit of CONVERGED that it has to be good to for a contradiction to be a change of the
// lens. Of the first lens it may be too sure by much at first, as the scene is not known either.
constexpr double kToldFirstLens = 0.5;
constexpr double kToldLens = 2.0;
// Times the limit of CONVERGED that the batch has to be good to, and an earlier setting near to it,
// to be the same: what is vague looks like one that is near, and stretches of both do not mix.
constexpr double kSameSetting = 0.4;

std::string describe(const Event& event) {
  return formatted(": by %.2f px rms over the image, noticed after %.1f s", event.magnitude_px,
                   1e-9 * static_cast<double>(event.stamp_ns - event.onset_stamp_ns));
}

}  // namespace

void BackEnd::considerCandidate(const KeyframeMessage& message, std::vector<Event>* events) {
  report_.queue.last_accepted = false;
  if (message.candidate.beginNs() < epoch_onset_ns_) {
    report_.queue.last_decision = "discarded: it straddles the change of the lens";
    return;
  }
  if (foregone(message)) return;
  const Candidate candidate =
      evaluateCandidate(CandidateOptions(), message.candidate, report_.camera);
  ChangeVerdict verdict;
  if (handed_over_) {
    verdict = detector_.examine(message.candidate, candidate, message.suspected_onset_ns, estimate_,
                                solution_);
  } else if (const auto reference = startupBefore(message.candidate.beginNs())) {
    verdict = detector_.examineUnfinished(message.candidate, candidate, *reference);
  }
  if (!handed_over_) rememberStartup();
  report_.change_p_value = verdict.p_value;
  switch (verdict.kind) {
    case ChangeVerdict::Kind::kSame:
      if (offer(candidate)) solveQueue();
      break;
    case ChangeVerdict::Kind::kDoubt:
    case ChangeVerdict::Kind::kBadData:
      report_.queue.last_decision = "held back: " + verdict.reason;
      break;
    case ChangeVerdict::Kind::kDrift:
      followDrift(verdict);
      break;
    case ChangeVerdict::Kind::kChange:
      changeEpoch(verdict, events);
      break;
  }
}

// Neighbouring windows share all keyframes but one, and most of them stand no chance against what
// the queue holds of the same time. One that says nothing against the lens either need not be
// solved.
bool BackEnd::foregone(const KeyframeMessage& message) {
  const CandidateOutlook outlook = outlookOf(message.candidate, report_.camera);
  if (!outlook.usable) return false;
  const QueueDecision decision = queue_.consider(outlook.best, report_.camera);
  if (decision.accepted) return false;
  std::optional<double> p_value = 1.0;
  if (handed_over_) {
    p_value = detector_.clearlySame(outlook, message.suspected_onset_ns, estimate_, solution_);
  } else if (!startup_course_.empty() || !fitsAsUsual(outlook.sigma_scale, estimate_)) {
    return false;  // each window is held against what the batch said before it
  }
  if (!p_value) return false;
  report_.change_p_value = *p_value;
  report_.queue.last_decision = decision.reason + " (at best: it was not solved)";
  return true;
}

// The present estimate goes on from what the alarm knows; the map, the poses and the queue of the
// epoch that ends keep their intrinsics.
void BackEnd::changeEpoch(const ChangeVerdict& verdict, std::vector<Event>* events) {
  putAway(verdict.onset_ns);
  const bool by_queue = handed_over_ && solution_.usable;
  const IntrinsicsMatrix covariance_before =
      by_queue ? solution_.covariance : startup_.covariance();
  if (by_queue) usual_scatter_ = solution_.scatter;
  Event event{EventType::kCalibrationChange, report_.stamp_ns, verdict.onset_ns, verdict.reason};
  // What is reported may have followed the change already, as a drift.
  const Camera& before = by_queue ? solution_.camera : report_.camera;
  event.magnitude_px = pixelDistance(before, verdict.camera).rms;
  event.p_value = verdict.p_value;
  event.sentence += describe(event);
  events->push_back(event);
  report_.last_change = event.sentence;
  ++report_.epoch;
  epoch_onset_ns_ = verdict.onset_ns;
  handed_over_ = report_.handed_over = false;
  report_.state = CalibrationState::kInitializing;
  clearQueue();
  detector_.reset();
  startup_.resume(verdict.camera, verdict.information, verdict.segment, covariance_before);
  adoptStartup(startupUncertainty());
  changed_ = true;
  for (const Candidate& candidate : verdict.recent) offer(candidate);
  if (!estimate_.candidates().empty()) solveQueue();
  report_.queue.last_decision = "the queue of the lens before the change was put away";
}

// The queue as it was before the change, for a setting that returns.
void BackEnd::putAway(std::int64_t onset_ns) {
  std::vector<std::int64_t> later;
  for (const Candidate& candidate : estimate_.candidates()) {
    if (candidate.segment.endNs() >= onset_ns) later.push_back(candidate.segment.sequence);
  }
  if (solution_.usable && !later.empty()) {
    queue_.remove(later);
    estimate_.remove(later);
    solution_ = estimate_.solve(solution_.camera);
  }
  settings_.store({report_.epoch, queue_, estimate_, solution_});
}

// The batch holds the newest keyframes too, so that what came before them has to be remembered.
void BackEnd::rememberStartup() {
  const double limit = (report_.epoch == 0 ? kToldFirstLens : kToldLens) * convergedRms();
  if (!(startupUncertainty().rms < limit)) return;
  const double sigmas = kStartupSigmas * usual_scatter_.inflation();
  startup_course_.emplace_back(
      report_.stamp_ns,
      Reference{startup_.camera(), startup_.information() / (sigmas * sigmas), usual_scatter_});
  if (startup_course_.size() > kStartupCourse) startup_course_.pop_front();
}

// What was known of the lens by then.
std::optional<Reference> BackEnd::startupBefore(std::int64_t stamp_ns) const {
  std::optional<Reference> newest;
  for (const auto& [known_at_ns, reference] : startup_course_) {
    if (known_at_ns < stamp_ns) newest = reference;
  }
  return newest;
}

void BackEnd::followDrift(const ChangeVerdict& verdict) {
  queue_.remove(verdict.stale);
  estimate_.remove(verdict.stale);
  for (const Candidate& candidate : verdict.recent) offer(candidate);
  report_.camera = verdict.camera;  // where the solve starts
  if (!estimate_.candidates().empty()) solveQueue();
  report_.queue.last_decision = verdict.reason + ": " + std::to_string(verdict.stale.size()) +
                                " segments that describe its past were retired";
}

LensDrift BackEnd::presentDrift() const {
  std::vector<Evidence> queue;
  for (const Candidate& candidate : estimate_.candidates()) queue.push_back(ownEvidence(candidate));
  return estimateDrift(queue, detector_.stretchesBeside(estimate_), solution_.camera,
                       report_.stamp_ns);
}

// A drifting lens is another one at each keyframe, whether the queue changes or not.
void BackEnd::considerDrift() {
  if (changed_ || !solution_.usable) return;
  if (solution_.drift.significant || presentDrift().significant) adoptSolution();
}

void BackEnd::recallSetting(std::vector<Event>* events) {
  const double limit = kSameSetting * convergedRms();
  if (!startup_.usable() || !(startupUncertainty().rms < limit)) return;
  const std::optional<Setting> setting =
      settings_.recall(startup_.camera(), startup_.information(), limit);
  if (!setting) return;
  queue_ = setting->queue;
  estimate_ = setting->estimate;
  solution_ = setting->solution;
  handed_over_ = report_.handed_over = true;
  adoptRowTime();  // it may have been learnt since then
  adoptSolution();
  events->push_back({EventType::kHandover, report_.stamp_ns, report_.stamp_ns,
                     "the lens is back at a setting known from epoch " +
                         std::to_string(setting->epoch) + ": its queue is in use again"});
}

}  // namespace camera_self_calibration
