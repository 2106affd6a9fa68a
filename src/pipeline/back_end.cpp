// A keyframe in the back end, from its window to the verdict.

#include "camera_self_calibration/pipeline/back_end.h"

#include <string>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/queue/candidate_outlook.h"

namespace camera_self_calibration {
namespace {

// Times the limit of CONVERGED that the batch has to be good to, and an earlier setting near to it,
// to be the same: what is vague looks like one that is near, and segments of both do not mix.
constexpr double kSameSetting = 0.4;

}  // namespace

BackEndOutput BackEnd::process(const KeyframeMessage& seen) {
  see(seen);
  if (phase_ != Phase::kHeld) {
    field_ = seen.field;
    const KeyframeMessage message = shutter_.freed(seen, known_.camera, isInformed(phase_));
    considerModel(message);
    if (isStarting(phase_)) runStartup(message.history);
    outcome_ = considerCandidate(message);
    considerDrift();
    recallSetting();
    considerRowTime();
    considerHandover();
    considerLensFit();
  }
  judge();
  return finish();
}

BackEndOutput BackEnd::hold(const KeyframeMessage& message, const std::string& remark) {
  see(message);
  judge();
  BackEndOutput output = finish();
  output.report.sentence += remark;
  for (Event& event : output.events) event.sentence += remark;
  return output;
}

void BackEnd::see(const KeyframeMessage& message) {
  stamp_ns_ = message.candidate.endNs();
  keyframes_ = message.keyframes;
}

void BackEnd::considerModel(const KeyframeMessage& message) {
  if (!options_.choose_model || (isStarting(phase_) && !startup_.isInformative())) return;
  model_choice_.observe(message.candidate);
  std::vector<Segment> observed;
  for (const Candidate& candidate : queue_.candidates()) {
    const bool restored = candidate.observed.keyframes.empty();
    observed.push_back(restored ? candidate.segment : candidate.observed);
  }
  const std::optional<Camera> camera =
      model_choice_.consider(keyframes_, observed, known_.camera, options_.solver_threads);
  if (camera) switchModel(*camera, observed);
}

// The queue's segments stay, scored anew; if their joint estimate fails, all stays as it was.
void BackEnd::switchModel(const Camera& camera, const std::vector<Segment>& observed) {
  std::vector<Candidate> candidates;
  for (const Segment& segment : observed) {
    candidates.push_back(evaluateCandidate(CandidateOptions(), segment, camera));
  }
  SegmentQueue queue = queue_;
  const int taken = queue.rebuild(candidates, shutter_.startFrom(camera));
  if (!isStarting(phase_) && !queue.solution().usable) return;
  startup_.switchModel(camera);
  clearQueue();
  queue_ = std::move(queue);
  shutter_.noteTaken(taken);
  known_ = Known();
  known_.camera = camera;
  if (!isStarting(phase_)) adoptSolution();
}

void BackEnd::runStartup(const Segment& history) {
  startup_.add(history);
  if (startup_.usable() && known_.camera.estimatedCount() != startup_.camera().estimatedCount()) {
    clearQueue();  // its segments were scored for another number of parameters
  }
  followTheBetter();
}

void BackEnd::followTheBetter() {
  const QueueStanding standing = queueStanding(startup_, queue_, field_);
  const QueueSolution& solution = queue_.solution();
  if (standing.doubt.empty()) startup_.beginNextFrom(solution.camera, solution.covariance);
  advance(betterEstimate(startup_, standing));
  if (phase_ == Phase::kQueueLeads) {
    adoptSolution();
  } else if (startup_.usable()) {
    // Intrinsics that nothing told would only do harm in front.
    if (phase_ == Phase::kStartupLeads) changed_ = true;
    adoptStartup(standing.startup_uncertainty);
  }
}

BackEnd::CandidateOutcome BackEnd::considerCandidate(const KeyframeMessage& message) {
  if (!isInformed(phase_)) {
    return {false, "not considered: all keyframes together tell nothing yet"};
  }
  if (watch_.straddlesChange(message.candidate)) {
    return {false, "discarded: it straddles the change of the lens"};
  }
  if (const auto skipped = canSkipSolve(message)) return *skipped;
  const Candidate candidate =
      evaluateCandidate(CandidateOptions(), message.candidate, known_.camera);
  const ChangeVerdict verdict =
      watch_.examine(message, candidate, queue_, phase_ == Phase::kHandedOver);
  if (isStarting(phase_)) {
    watch_.remember(stamp_ns_, startup_, startupUncertainty(startup_, field_), convergedRms());
  }
  change_p_value_ = verdict.p_value;
  switch (verdict.kind) {
    case ChangeVerdict::Kind::kSame:
      return offer(candidate);
    case ChangeVerdict::Kind::kDoubt:
    case ChangeVerdict::Kind::kBadData:
      return {false, "held back: " + verdict.reason};
    case ChangeVerdict::Kind::kDrift:
      return followDrift(verdict);
    case ChangeVerdict::Kind::kChange:
      return beginLens(verdict);
  }
  return {};
}

// Neighbouring windows share all keyframes but one, and most of them stand no chance against what
// the queue holds of the same time. One that says nothing against the lens either need not be
// solved.
std::optional<BackEnd::CandidateOutcome> BackEnd::canSkipSolve(const KeyframeMessage& message) {
  const CandidateOutlook outlook = outlookOf(message.candidate, known_.camera);
  if (!outlook.usable) return std::nullopt;
  const QueueDecision decision = queue_.consider(outlook.best, known_.camera);
  if (decision.accepted) return std::nullopt;
  const std::optional<double> p_value =
      watch_.clearlySame(message, outlook, queue_, phase_ == Phase::kHandedOver);
  if (!p_value) return std::nullopt;
  change_p_value_ = *p_value;
  return CandidateOutcome{false, decision.reason + " (at best: it was not solved)"};
}

BackEnd::CandidateOutcome BackEnd::offer(const Candidate& candidate) {
  const QueueDecision decision = queue_.offer(candidate, queueStart());
  if (decision.accepted) adoptChange(1);
  return {decision.accepted, decision.reason};
}

BackEnd::CandidateOutcome BackEnd::followDrift(const ChangeVerdict& verdict) {
  known_.camera = verdict.camera;  // where the estimate starts
  adoptChange(queue_.exchange(verdict.stale, verdict.recent, queueStart()));
  return {false, verdict.reason + ": " + std::to_string(verdict.stale.size()) +
                     " segments that describe its past were retired"};
}

// A drifting lens is another one at each keyframe, whether the queue changes or not.
void BackEnd::considerDrift() {
  if (phase_ != Phase::kHandedOver || changed_ || !queue_.solution().usable) return;
  if (queue_.solution().drift.significant || watch_.drift(queue_, stamp_ns_).significant) {
    adoptSolution();
  }
}

void BackEnd::recallSetting() {
  if (!isStarting(phase_) || !startup_.usable()) return;
  const double limit = kSameSetting * convergedRms();
  if (!(startupUncertainty(startup_, field_).rms < limit)) return;
  const std::optional<Setting> setting =
      settings_.recall(startup_.camera(), startup_.information(), limit);
  if (!setting) return;
  queue_ = setting->queue;
  advance(PhaseTrigger::kQueueReady);
  adoptRowTime();  // it may have been learnt since then
  adoptSolution();
  raise(EventType::kHandover, "the lens is back at a setting known from epoch " +
                                  std::to_string(setting->epoch) + ": its queue is in use again");
}

void BackEnd::considerRowTime() {
  const bool another =
      isStarting(phase_) ? shutter_.ask(startup_) : shutter_.ask(queue_, outcome_.accepted);
  if (another) adoptRowTime();
}

// The queue's segments stay, evaluated anew.
void BackEnd::adoptRowTime() {
  const double row_time_s = shutter_.rowTime().inUse();
  if (isStarting(phase_)) startup_.setRowTime(row_time_s);
  model_choice_.setRowTime(row_time_s, known_.camera);
  watch_.forgetWindows();
  std::vector<Candidate> freed;
  for (const Candidate& candidate : queue_.candidates()) {
    freed.push_back(shutter_.freed(candidate, known_.camera));
  }
  queue_.rebuild(freed, queueStart());
  shutter_.noteFreed();
  if (isStarting(phase_)) {
    followTheBetter();
  } else if (queue_.solution().usable) {
    adoptSolution();
  }
  changed_ = true;
}

void BackEnd::considerHandover() {
  if (!isStarting(phase_)) return;
  if (options_.choose_model && !model_choice_.settled()) {
    obstacle_ = "the lens model is not chosen yet";
    return;
  }
  const HandoverLimits limits{2.0 * convergedRms(), options_.handover_entropy};
  const QueueStanding standing = queueStanding(startup_, queue_, field_);
  obstacle_ = standing.doubt;
  if (standing.contradicts_startup && standing.startup_uncertainty.rms < limits.pixel_rms) {
    clearQueue();  // filled from a start that was wrong
  }
  if (!obstacle_.empty() || !startup_.usable()) return;
  obstacle_ = shortfall(standing, queue_.solution(), limits);
  if (!obstacle_.empty()) return;
  advance(PhaseTrigger::kQueueReady);
  adoptSolution();
  raise(EventType::kHandover,
        formatted("the calibration now rests on several segments of video (the queue), good to "
                  "%.2f px rms (limit %.2f px)",
                  uncertainty().rms, limits.pixel_rms));
}

// Ahead of every verdict, so that no lens is called CONVERGED that its model does not describe.
void BackEnd::considerLensFit() {
  if (isStarting(phase_)) return;
  const bool verdict_due =
      health_.state != CalibrationState::kConverged && known_.noise.rms <= convergedRms();
  if (lens_fit_.consider(keyframes_, verdict_due, queue_.candidates(), queue_.solution(), field_,
                         options_.solver_threads)) {
    adoptSolution();
  }
}

void BackEnd::adoptStartup(const PixelError& uncertainty) {
  known_ = {startup_.heldCamera(), startup_.covariance(), uncertainty};
}

void BackEnd::adoptSolution() {
  queue_.setDrift(watch_.drift(queue_, stamp_ns_));
  known_.camera = queue_.solution().present();
  known_.covariance = queue_.solution().presentCovariance();
  known_.noise = pixelUncertainty(known_.camera, known_.covariance, field_);
  changed_ = true;
}

// The queue took so many candidates and was solved.
void BackEnd::adoptChange(int taken) {
  swaps_ += taken;
  shutter_.noteTaken(taken);
  if (!isStarting(phase_) && queue_.solution().usable) adoptSolution();
}

void BackEnd::clearQueue() {
  queue_.clear();
  watch_.forgetStartup();
  lens_fit_ = LensFit(LensFitOptions());
  advance(startup_.isInformative() ? PhaseTrigger::kStartupBetter : PhaseTrigger::kUninformed);
}

// From where the queue's poses and depths are: before hand-over the camera in use may be the
// startup batch's.
QueueStart BackEnd::queueStart() const {
  const Camera& solved = queue_.solution().camera;
  const bool goes_on = isStarting(phase_) && queue_.solution().usable &&
                       solved.model() == known_.camera.model() &&
                       solved.estimatedCount() == known_.camera.estimatedCount();
  return shutter_.startFrom(goes_on ? solved : known_.camera);
}

}  // namespace camera_self_calibration
