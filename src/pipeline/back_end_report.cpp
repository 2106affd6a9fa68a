#include "camera_self_calibration/pipeline/back_end_report.h"

#include <string>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/estimation/entropy.h"

namespace camera_self_calibration {
namespace {

// Of a verdict, with what else is to be said.
std::string sentenceOf(const HealthVerdict& verdict, const BackEndState& state) {
  std::string sentence = verdict.sentence;
  const std::string choice = state.model_choice.sentence();
  if (!choice.empty()) sentence += "; " + choice;
  if (isStarting(state.phase)) {
    const LensFitReport& fit = state.lens_fit.report();
    return fit.refuted && !state.chooses_model ? sentence + "; " + fit.sentence() : sentence;
  }
  for (const std::string& remark :
       {state.known.cross_validation.sentence(), state.lens_fit.report().sentence(),
        state.known.observed.unseen_corners}) {
    if (!remark.empty()) sentence += "; " + remark;
  }
  const LensDrift& drift = state.queue.solution().drift;
  if (!drift.told) return sentence;
  return sentence +
         formatted("; the focal length drifts by about %.2g %% per minute", 100.0 * drift.rate);
}

SegmentReport reportOf(const Candidate& candidate) {
  SegmentReport report;
  report.sequence = candidate.segment.sequence;
  report.begin_ns = candidate.segment.beginNs();
  report.end_ns = candidate.segment.endNs();
  report.entropy = candidate.entropy;
  report.keyframes = static_cast<int>(candidate.segment.keyframes.size());
  report.landmarks = static_cast<int>(candidate.segment.landmarks.size());
  report.observations = static_cast<int>(candidate.segment.observations.size());
  return report;
}

}  // namespace

HealthVerdict verdictOn(const BackEndState& state, double converged_rms, CalibrationState before) {
  if (state.phase == Phase::kHeld) {
    return {CalibrationState::kConverged, "the intrinsics were given and are held", ""};
  }
  const bool by_queue = queueLeads(state.phase);
  const LensFitReport& fit = state.lens_fit.report();
  HealthEvidence evidence;
  evidence.keyframes = static_cast<int>(state.keyframesOfLens());
  evidence.maps = state.maps;
  evidence.longest_map = static_cast<int>(state.longest_map);
  evidence.needed_keyframes = 2 * state.segment_keyframes;
  evidence.has_estimate = by_queue || state.startup.usable();
  evidence.handed_over = !isStarting(state.phase);
  evidence.information =
      by_queue ? state.queue.solution().information : state.startup.information();
  evidence.uncertainty = state.uncertainty();
  evidence.seeing_share = state.field.share();
  evidence.threshold_px = converged_rms;
  if (by_queue) evidence.blind_below_px = state.known.cross_validation.blindBelowPx();
  evidence.epoch = state.counters.epoch;
  evidence.obstacle = state.obstacle;
  evidence.segments_disagree =
      !state.obstacle.empty() && state.queue.solution().scatter.birgeRatio() > kMaxBirgeRatio;
  // Where the model is chosen, a better one follows by itself.
  if (fit.better.empty() || !state.chooses_model) {
    evidence.model_misses =
        fit.refuted && (!evidence.handed_over || fit.misfit.rms > state.known.noise.rms);
    evidence.better_model = fit.better;
  }
  evidence.model_was_given = !state.chooses_model;
  return judgeHealth(evidence, state.known.camera, before);
}

CalibrationReport reportOf(const BackEndState& state, double converged_rms) {
  CalibrationReport report;
  report.stamp_ns = state.stamp_ns;
  report.state = state.health.state;
  report.sentence = sentenceOf(state.health, state);
  report.hint = state.health.hint;
  if (report.state == CalibrationState::kConverged) {
    HealthVerdict afresh = verdictOn(state, converged_rms, CalibrationState::kConverging);
    if (afresh.state != report.state) {
      afresh.sentence = sentenceOf(afresh, state);
      report.afresh = std::move(afresh);
    }
  }
  report.camera = state.known.camera;
  report.covariance = state.known.covariance;
  if (queueLeads(state.phase)) {
    report.scatter_freedom = state.queue.solution().scatter.birgeFreedom();
  }
  report.uncertainty = state.uncertainty();
  report.entropy = entropy(state.known.camera, state.known.covariance);
  report.revision = state.counters.revision;
  report.epoch = state.counters.epoch;
  report.change_p_value = state.change_p_value;
  report.last_change = state.last_change;
  report.last_change_ns = state.last_change_ns;
  report.handed_over = !isStarting(state.phase);
  report.keyframes = state.keyframes;
  report.queue.swaps = state.swaps;
  report.queue.last_accepted = state.outcome.accepted;
  report.queue.last_decision = state.outcome.reason;
  for (const Candidate& candidate : state.queue.candidates()) {
    report.queue.segments.push_back(reportOf(candidate));
  }
  report.shutter = state.shutter.report();
  report.observed = state.known.observed;
  report.cross_validation = state.known.cross_validation;
  report.lens_fit = state.lens_fit.report();
  report.models = state.model_choice.evidence();
  return report;
}

CalibrationUpdate updateOf(const BackEndState& state) {
  CalibrationUpdate update;
  update.camera = state.known.camera;
  update.generation = state.counters.revision;
  update.handed_over = state.phase == Phase::kHandedOver;
  update.uncertainty_px = state.uncertainty().rms;
  update.epoch = state.counters.epoch;
  update.line_delay_s = state.shutter.lineDelay().inUse();
  update.onset_ns = state.watch.onsetNs();
  if (!queueLeads(state.phase)) update.solution = state.startup.segment();
  return update;
}

std::shared_ptr<const LearntState> learntStateOf(const BackEndState& state) {
  if (isStarting(state.phase) || state.phase == Phase::kHeld) return nullptr;
  auto learnt = std::make_shared<LearntState>();
  learnt->camera = state.known.camera;
  learnt->state = state.health.state;
  learnt->stamp_ns = state.stamp_ns;
  learnt->keyframes = state.keyframes;
  learnt->revision = state.counters.revision;
  learnt->epoch = state.counters.epoch;
  learnt->line_delay_s = state.shutter.lineDelay().inUse();
  const LineDelayEstimate& line_delay = state.shutter.lineDelay().estimate();
  if (line_delay.usable) learnt->line_delay_sigma_s = line_delay.sigma_s;
  learnt->segments = state.queue.candidates();
  return learnt;
}

}  // namespace camera_self_calibration
