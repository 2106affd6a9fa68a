#include "camera_self_calibration/pipeline/back_end.h"

#include <algorithm>
#include <string>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/pipeline/back_end_report.h"
#include "camera_self_calibration/pipeline/handover.h"
#include "camera_self_calibration/queue/candidate_outlook.h"
#include "camera_self_calibration/queue/observed_area.h"

namespace camera_self_calibration {
namespace {

// Times the limit of CONVERGED that the batch has to be good to, and an earlier setting near to it,
// to be the same: what is vague looks like one that is near, and segments of both do not mix.
constexpr double kSameSetting = 0.4;

}  // namespace

BackEndOutput BackEnd::process(const KeyframeMessage& seen) {
  see(seen);
  if (state_.phase != Phase::kHeld) {
    state_.field = seen.field;
    const KeyframeMessage message =
        state_.shutter.freed(seen, state_.known.camera, isInformed(state_.phase));
    if (isStarting(state_.phase)) runStartup(message.history);
    state_.outcome = considerCandidate(message);
    considerWrongSegment();
    considerDrift();
    recallSetting();
    considerLineDelay();
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
  if (message.candidate.endNs() < state_.stamp_ns) state_.watch.forgetStamps();
  state_.stamp_ns = message.candidate.endNs();
  // The front end goes on counting where a saved state ended.
  if (state_.keyframes == 0) state_.earlier_keyframes = message.keyframes - 1;
  state_.keyframes = message.keyframes;
  if (message.candidate.keyframes.size() == 1) {
    ++state_.maps;
    state_.map_begin = state_.keyframes;
  }
  state_.longest_map = std::max(state_.longest_map, state_.keyframes - state_.map_begin + 1);
}

void BackEnd::runStartup(const Segment& history) {
  state_.startup.add(history);
  const Camera& present = state_.startup.camera();
  if (state_.startup.usable() && !state_.known.camera.estimatesSameAs(present)) {
    clearQueue();  // its segments were scored for other parameters
  }
  keepFinishedBatch();
  followTheBetter();
  considerStartupModel();
}

// What a batch forgets, as the camera moves on, is kept as a segment, if it was good enough for
// hand-over: what is vague may be a wrong minimum.
void BackEnd::keepFinishedBatch() {
  const std::optional<Startup::Solution> finished = state_.startup.takeFinished();
  if (!finished || !(finished->rms < handoverLimits().pixel_rms)) return;
  const Candidate candidate =
      evaluateCandidate(CandidateOptions(), finished->segment, finished->camera);
  offer(state_.shutter.freed(candidate, finished->camera));
}

void BackEnd::followTheBetter() {
  const QueueStanding standing = queueStanding(state_.startup, state_.queue, state_.field);
  const QueueSolution& solution = state_.queue.solution();
  if (standing.doubt.empty()) state_.startup.beginNextFrom(solution.camera, solution.covariance);
  advance(betterEstimate(state_.startup, standing, handoverLimits()));
  if (state_.phase == Phase::kQueueLeads) {
    adoptSolution();
  } else if (state_.startup.usable()) {
    // Intrinsics that nothing told would only do harm in front.
    if (state_.phase == Phase::kStartupLeads) changed_ = true;
    adoptStartup(standing.startup_uncertainty);
  }
}

CandidateOutcome BackEnd::considerCandidate(const KeyframeMessage& message) {
  if (!isInformed(state_.phase)) {
    return {false, "not considered: all keyframes together do not determine the lens yet"};
  }
  if (state_.watch.straddlesChange(message.candidate)) {
    return {false, "discarded: it contains the change of the lens"};
  }
  if (const auto skipped = canSkipSolve(message)) return *skipped;
  const Candidate candidate =
      evaluateCandidate(CandidateOptions(), message.candidate, state_.known.camera);
  const ChangeVerdict verdict =
      state_.watch.examine(message, candidate, state_.queue, state_.phase == Phase::kHandedOver);
  if (isStarting(state_.phase)) {
    state_.watch.remember(state_.stamp_ns, state_.startup,
                          startupUncertainty(state_.startup, state_.field), convergedRms());
  }
  state_.change_p_value = verdict.p_value;
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
std::optional<CandidateOutcome> BackEnd::canSkipSolve(const KeyframeMessage& message) {
  const CandidateOutlook outlook = outlookOf(message.candidate, state_.known.camera);
  if (!outlook.usable) return std::nullopt;
  const QueueDecision decision = state_.queue.consider(outlook.best, state_.known.camera);
  if (decision.accepted) return std::nullopt;
  const std::optional<double> p_value =
      state_.watch.clearlySame(message, outlook, state_.queue, state_.phase == Phase::kHandedOver);
  if (!p_value) return std::nullopt;
  state_.change_p_value = *p_value;
  return CandidateOutcome{
      false, decision.reason + " (even at its best possible score, so it was not solved)"};
}

CandidateOutcome BackEnd::offer(const Candidate& candidate) {
  const QueueDecision decision = state_.queue.offer(candidate, queueStart());
  if (decision.accepted) adoptChange(1);
  return {decision.accepted, decision.reason};
}

CandidateOutcome BackEnd::followDrift(const ChangeVerdict& verdict) {
  state_.known.camera = verdict.camera;  // where the estimate starts
  adoptChange(state_.queue.exchange(verdict.stale, verdict.recent, queueStart()));
  return {false, verdict.reason + ": " + std::to_string(verdict.stale.size()) +
                     " segments from earlier were removed"};
}

// A segment of things that move scores as well as any, and would stay for ever. Two are left, which
// check each other.
void BackEnd::considerWrongSegment() {
  const bool spare = state_.queue.candidates().size() > 2;
  const bool news = state_.outcome.accepted || state_.watch.hasNews();
  if (!spare || !news || !state_.queue.solution().usable) return;
  const std::optional<std::int64_t> wrong =
      state_.watch.wrongSegment(state_.queue, state_.stamp_ns);
  if (!wrong) return;
  adoptChange(state_.queue.exchange({*wrong}, {}, queueStart()));
  state_.outcome.reason += "; a segment that all others contradict was removed";
}

// A drifting lens is another one at each keyframe, whether the queue changes or not.
void BackEnd::considerDrift() {
  if (state_.phase != Phase::kHandedOver || changed_ || !state_.queue.solution().usable) return;
  if (state_.queue.solution().drift.significant ||
      (state_.watch.hasNews() && state_.watch.drift(state_.queue, state_.stamp_ns).significant)) {
    adoptSolution();
  }
}

void BackEnd::recallSetting() {
  if (!isStarting(state_.phase) || !state_.startup.usable()) return;
  const double limit = kSameSetting * convergedRms();
  if (!(startupUncertainty(state_.startup, state_.field).rms < limit)) return;
  const std::optional<Setting> setting = state_.settings.recall(
      state_.startup.camera(), state_.startup.information(), state_.field, limit);
  if (!setting) return;
  SegmentQueue queue = setting->queue;
  const Camera camera = queue.solution().camera;
  // The line delay may have been learnt since then.
  queue.rebuild(state_.shutter.freed(queue.candidates(), camera), state_.shutter.startFrom(camera));
  if (!queue.solution().usable) return;
  state_.queue = std::move(queue);
  state_.shutter.noteFreed();
  state_.lens_fit = LensFit(LensFitOptions());
  advance(PhaseTrigger::kQueueReady);
  adoptSolution();
  raise(EventType::kHandover, "the lens is back at a setting known from epoch " +
                                  std::to_string(setting->epoch) + ": its queue is in use again");
}

void BackEnd::considerLineDelay() {
  const bool another = isStarting(state_.phase)
                           ? state_.shutter.ask(state_.startup)
                           : state_.shutter.ask(state_.queue, state_.outcome.accepted);
  if (another) adoptLineDelay();
}

// The queue's segments stay, evaluated anew.
void BackEnd::adoptLineDelay() {
  const double line_delay_s = state_.shutter.lineDelay().inUse();
  if (isStarting(state_.phase)) state_.startup.setLineDelay(line_delay_s);
  state_.watch.forgetWindows();
  state_.queue.rebuild(state_.shutter.freed(state_.queue.candidates(), state_.known.camera),
                       queueStart());
  state_.shutter.noteFreed();
  if (isStarting(state_.phase)) {
    followTheBetter();
  } else if (state_.queue.solution().usable) {
    adoptSolution();
  }
  changed_ = true;
}

void BackEnd::considerHandover() {
  if (!isStarting(state_.phase)) return;
  const HandoverLimits limits = handoverLimits();
  const PixelError startup_uncertainty = startupUncertainty(state_.startup, state_.field);
  if (state_.queue.candidates().size() < 2 && startup_uncertainty.rms < limits.pixel_rms) {
    offerHalves();
  }
  const QueueStanding standing = queueStanding(state_.startup, state_.queue, state_.field);
  state_.obstacle = standing.doubt;
  if (standing.contradicts_startup && standing.startup_uncertainty.rms < limits.pixel_rms) {
    clearQueue();  // filled from a start that was wrong
  }
  if (!state_.obstacle.empty() || !state_.startup.usable()) return;
  state_.obstacle = shortfall(standing, state_.queue.solution(), limits);
  if (!state_.obstacle.empty()) return;
  advance(PhaseTrigger::kQueueReady);
  adoptSolution();
  raise(EventType::kHandover,
        formatted(
            "startup has ended: the calibration now rests on a queue of video segments, good to "
            "%.2f px rms (limit %.2f px)",
            state_.uncertainty().rms, limits.pixel_rms));
}

void BackEnd::advance(PhaseTrigger trigger) {
  state_.phase = after(state_.phase, trigger);
  state_.queue.setFilling(isStarting(state_.phase));
}

HandoverLimits BackEnd::handoverLimits() const {
  return {2.0 * convergedRms(), options_.handover_entropy};
}

// Windows that overlap replace one another, so that a short video, or slow motion, seldom leaves
// two separate ones. The batch has seen enough for both.
void BackEnd::offerHalves() {
  if (state_.startup.solved().sequence == halves_offered_) return;
  halves_offered_ = state_.startup.solved().sequence;
  std::vector<Candidate> halves;
  for (const Segment& half : state_.startup.halves()) {
    halves.push_back(evaluateCandidate(CandidateOptions(), half, state_.startup.camera()));
  }
  adoptChange(state_.queue.offer(halves, queueStart()));
}

void BackEnd::judge() {
  state_.health = verdictOn(state_, convergedRms(), state_.health.state);
  const bool converged = state_.health.state == CalibrationState::kConverged;
  if (converged && !converged_told_) raise(EventType::kConverged, state_.health.sentence);
  if (!converged && converged_told_) raise(EventType::kNoLongerConverged, state_.health.sentence);
  converged_told_ = converged;
}

BackEndOutput BackEnd::finish() {
  BackEndOutput output;
  if (changed_) {
    ++state_.counters.revision;
    output.update = updateOf(state_);
  }
  changed_ = false;
  output.events = std::exchange(events_, {});
  for (Event& event : output.events) event.epoch = state_.counters.epoch;
  output.report = reportOf(state_, convergedRms());
  return output;
}

void BackEnd::raise(EventType type, const std::string& sentence) {
  events_.push_back({type, state_.stamp_ns, state_.stamp_ns, sentence});
}

void BackEnd::adoptStartup(const PixelError& uncertainty) {
  state_.known = KnownLens();
  state_.known.camera = state_.startup.heldCamera();
  state_.known.covariance = state_.startup.covariance();
  state_.known.noise = uncertainty;
}

void BackEnd::adoptSolution() {
  state_.queue.setDrift(state_.watch.drift(state_.queue, state_.stamp_ns));
  const QueueSolution& solution = state_.queue.solution();
  KnownLens& known = state_.known;
  known.camera = solution.present();
  known.covariance = solution.presentCovariance();
  known.cross_validation = crossValidate(solution, state_.field);
  known.observed_area = observedArea(state_.queue.candidates(), known.camera, state_.field);
  known.observed.features =
      std::make_shared<const ImageWeights>(featureWeights(state_.queue.candidates(), known.camera));
  stateUncertainty();
  changed_ = true;
}

// All that is known to be wrong with the queue's estimate: noise, halves that disagree, a lens
// model that does not fit.
void BackEnd::stateUncertainty() {
  KnownLens& known = state_.known;
  const auto noise = [&](const ImageField& field) {
    return pixelUncertainty(known.camera, known.covariance, field)
        .scaled(known.cross_validation.inflation());
  };
  known.noise = noise(state_.field);
  known.observed.share = known.observed_area.share() / state_.field.share();
  known.observed.uncertainty =
      noise(known.observed_area).inQuadrature(state_.lens_fit.report().misfit_observed);
  known.observed.unseen_corners = unseenCorners(known.observed_area, state_.field);
}

// The queue took so many candidates and was solved.
void BackEnd::adoptChange(int taken) {
  state_.swaps += taken;
  state_.shutter.noteTaken(taken);
  if (!isStarting(state_.phase) && state_.queue.solution().usable) adoptSolution();
}

void BackEnd::clearQueue() {
  state_.queue.clear();
  state_.startup.forgetNext();
  state_.watch.forgetStartup();
  state_.lens_fit = LensFit(LensFitOptions());
  advance(state_.startup.isInformative() ? PhaseTrigger::kStartupBetter
                                         : PhaseTrigger::kUninformed);
}

// From where the queue's poses and depths are: before hand-over the camera in use may be the
// startup batch's.
QueueStart BackEnd::queueStart() const {
  const Camera& solved = state_.queue.solution().camera;
  const bool goes_on = isStarting(state_.phase) && state_.queue.solution().usable &&
                       solved.estimatesSameAs(state_.known.camera);
  return state_.shutter.startFrom(goes_on ? solved : state_.known.camera);
}

}  // namespace camera_self_calibration
