#include "camera_self_calibration/pipeline/back_end.h"

#include <limits>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/estimation/entropy.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/map/rolling_shutter.h"
#include "camera_self_calibration/queue/observed_area.h"

namespace camera_self_calibration {
namespace {

StartupOptions startupOptions(const Options& options) {
  StartupOptions startup;
  startup.max_keyframes = options.startup_keyframes;
  startup.choose_model = !options.model;
  return startup;
}

std::string drifting(const LensDrift& drift) {
  return formatted("; the focal length drifts by some %.2g %% a minute", 100.0 * drift.rate);
}

}  // namespace

BackEnd::BackEnd(const Options& options, const Camera& camera)
    : options_(options),
      model_choice_(ModelChoiceOptions()),
      lens_fit_(LensFitOptions()),
      startup_(startupOptions(options), camera),
      queue_(options.queue_segments, options.alpha, options.score),
      estimate_(options.solver_threads),
      detector_(options.false_alarms_per_hour),
      row_time_(options.readout_s / rowSteps(camera.height()), rowSteps(camera.height())) {
  report_.camera = camera;
  report_.uncertainty = PixelError::unknown();
  report_.entropy = std::numeric_limits<double>::infinity();
}

BackEndOutput BackEnd::process(const KeyframeMessage& seen) {
  const std::optional<KeyframeMessage> freed_message = freed(seen);
  const KeyframeMessage& message = freed_message ? *freed_message : seen;
  field_ = message.field;
  BackEndOutput output;
  report_.stamp_ns = message.candidate.endNs();
  report_.keyframes = message.keyframes;
  if (options_.fix_intrinsics) {
    reportHeldIntrinsics();
    output.report = report_;
    return output;
  }
  if (!handed_over_) runStartup(message);
  if (handed_over_ || follows_queue_ || startup_.tellsLens()) {
    considerCandidate(message, &output.events);
  } else {
    report_.queue.last_decision = "not considered: all keyframes together tell nothing yet";
  }
  if (handed_over_) considerDrift();
  if (!handed_over_) recallSetting(&output.events);
  considerRowTime();
  if (!handed_over_) considerHandover(report_.stamp_ns, &output.events);
  considerLensFit();
  judge(report_.stamp_ns, &output.events);
  return finish(std::move(output));
}

BackEndOutput BackEnd::finish(BackEndOutput output) {
  fillQueueReport();
  reportShutter();
  if (changed_) {
    ++report_.revision;
    output.update.emplace();
    output.update->camera = report_.camera;
    output.update->generation = report_.revision;
    output.update->handed_over = handed_over_;
    output.update->uncertainty_px = report_.uncertainty.rms;
    output.update->epoch = report_.epoch;
    output.update->row_time_s = row_time_.inUse();
    output.update->onset_ns = epoch_onset_ns_;
    if (!handed_over_ && !follows_queue_) output.update->solution = startup_.segment();
  }
  changed_ = false;
  for (Event& event : output.events) event.epoch = report_.epoch;
  output.report = report_;
  return output;
}

BackEndOutput BackEnd::hold(const KeyframeMessage& message, const std::string& remark) {
  BackEndOutput output;
  if (message.keyframes > 0) {
    report_.stamp_ns = message.candidate.endNs();
    report_.keyframes = message.keyframes;
  }
  judge(report_.stamp_ns, &output.events);
  output = finish(std::move(output));
  output.report.sentence += remark;
  return output;
}

bool BackEnd::restore(const LearntState& state) {
  const Camera& own = report_.camera;
  const bool same_model = !options_.model || state.camera.model() == own.model();
  if (!state.problems().empty() || !same_model || state.camera.width() != own.width() ||
      state.camera.height() != own.height()) {
    return false;
  }
  BackEnd restored = *this;
  restored.report_.camera = state.camera;
  restored.report_.state = state.state;  // CONVERGED is left on a change or a reset only
  restored.report_.stamp_ns = state.stamp_ns;
  restored.report_.keyframes = state.keyframes;
  restored.report_.revision = state.revision;
  restored.report_.epoch = state.epoch;
  restored.restoreShutter(state);
  for (const Candidate& candidate : state.segments) {
    restored.offer(withRowTime(candidate, restored.row_time_.inUse(), state.camera));
  }
  restored.handed_over_ = restored.report_.handed_over = true;
  restored.solveQueue();
  if (!restored.solution_.usable) return false;
  restored.report_.queue.last_decision = "restored";
  *this = restored;
  return true;
}

BackEndOutput BackEnd::merge(const std::vector<Candidate>& candidates) {
  bool accepted = false;
  for (const Candidate& candidate : candidates) {
    if (candidate.information.rows() != report_.camera.estimatedCount()) continue;
    if (offer(withRowTime(candidate, row_time_.inUse(), report_.camera))) accepted = true;
  }
  if (accepted) solveQueue();
  changed_ = true;
  return hold(KeyframeMessage(), "");
}

std::shared_ptr<const LearntState> BackEnd::state() const {
  if (!handed_over_) return nullptr;
  auto state = std::make_shared<LearntState>();
  state->camera = report_.camera;
  state->state = report_.state;
  state->stamp_ns = report_.stamp_ns;
  state->keyframes = report_.keyframes;
  state->revision = report_.revision;
  state->epoch = report_.epoch;
  state->row_time_s = row_time_.inUse();
  if (row_time_.estimate().usable) state->row_time_sigma_s = row_time_.estimate().sigma_s;
  state->segments = estimate_.candidates();
  return state;
}

void BackEnd::reportHeldIntrinsics() {
  report_.state = CalibrationState::kConverged;
  report_.sentence = "the intrinsics were given and are held";
  report_.uncertainty = {0.0, 0.0};
  report_.handed_over = true;
}

void BackEnd::clearQueue() {
  queue_.clear();
  estimate_.clear();
  solution_ = QueueSolution();
  startup_course_.clear();
  follows_queue_ = false;
  lens_fit_ = LensFit(LensFitOptions());
}

bool BackEnd::offer(const Candidate& candidate) {
  SegmentScore score;
  score.sequence = candidate.segment.sequence;
  score.begin_ns = candidate.segment.beginNs();
  score.end_ns = candidate.segment.endNs();
  score.entropy = candidate.entropy;
  score.pixel_rms = candidate.uncertainty.rms;
  score.information = candidate.information;
  score.well_posed = candidate.well_posed;
  const QueueDecision decision = queue_.offer(score, candidate.camera);
  report_.queue.last_accepted = decision.accepted;
  report_.queue.last_decision =
      candidate.well_posed ? decision.reason : "refused: " + candidate.reason;
  if (!decision.accepted) return false;
  ++report_.queue.swaps;
  estimate_.remove(decision.replaced);
  estimate_.add(candidate);
  ++swaps_since_row_time_;
  return true;
}

void BackEnd::solveQueue() {
  // From where its poses and depths are; before hand-over the report follows the startup batch.
  const bool known = solution_.usable && solution_.camera.model() == report_.camera.model() &&
                     solution_.camera.estimatedCount() == report_.camera.estimatedCount();
  solution_ = estimate_.solve(handed_over_ || !known ? report_.camera : solution_.camera);
  solution_.addUncertaintyOf(row_time_.estimate(), row_time_.doubt());
  if (handed_over_ && solution_.usable) adoptSolution();
}

void BackEnd::adoptSolution() {
  solution_.drift = presentDrift();
  report_.camera = solution_.present();
  report_.covariance = solution_.presentCovariance();
  report_.cross_validation = crossValidate(solution_, field_);
  observed_ = observedArea(estimate_.candidates(), report_.camera, field_);
  stateUncertainty();
  report_.entropy = entropy(report_.camera, report_.covariance);
  changed_ = true;
}

// All that is known to be wrong with the estimate: noise, halves that disagree, a lens model that
// does not fit.
void BackEnd::stateUncertainty() {
  const double inflation = report_.cross_validation.inflation();
  const auto noise = [&](const ImageField& field) {
    return pixelUncertainty(report_.camera, report_.covariance, field).scaled(inflation);
  };
  report_.lens_fit = lens_fit_.report();
  noise_ = noise(field_);
  report_.uncertainty = noise_.inQuadrature(report_.lens_fit.misfit);
  ObservedReport& observed = report_.observed;
  observed.share = observed_.share() / field_.share();
  observed.uncertainty = noise(observed_).inQuadrature(report_.lens_fit.misfit_observed);
  observed.unseen_corners = unseenCorners(observed_, field_);
}

void BackEnd::judge(std::int64_t stamp_ns, std::vector<Event>* events) {
  HealthEvidence evidence;
  evidence.keyframes = static_cast<int>(report_.keyframes);
  const bool by_queue = handed_over_ || follows_queue_;
  evidence.has_estimate = by_queue || startup_.usable();
  evidence.handed_over = handed_over_;
  evidence.information = by_queue ? solution_.information : startup_.information();
  evidence.uncertainty = report_.uncertainty;
  evidence.seeing_share = field_.share();
  evidence.threshold_px = convergedRms();
  evidence.epoch = report_.epoch;
  evidence.obstacle = obstacle_;
  const LensFitReport& fit = report_.lens_fit;
  // What the user can do about it; where the model is chosen it follows by itself.
  if (fit.misfit.rms > noise_.rms && options_.model) evidence.better_model = fit.better;
  const bool was_converged = report_.state == CalibrationState::kConverged;
  const HealthVerdict verdict = judgeHealth(evidence, report_.camera, was_converged);
  report_.state = verdict.state;
  report_.sentence = verdict.sentence;
  const std::string choice = model_choice_.sentence();
  if (!choice.empty()) report_.sentence += "; " + choice;
  if (handed_over_) {
    for (const std::string& remark :
         {report_.cross_validation.sentence(), fit.sentence(), report_.observed.unseen_corners}) {
      if (!remark.empty()) report_.sentence += "; " + remark;
    }
  }
  if (handed_over_ && solution_.drift.significant) report_.sentence += drifting(solution_.drift);
  report_.hint = verdict.hint;
  if (verdict.state == CalibrationState::kConverged && !was_converged) {
    events->push_back({EventType::kConverged, stamp_ns, stamp_ns, verdict.sentence});
  }
}

void BackEnd::fillQueueReport() {
  report_.queue.segments.clear();
  for (const Candidate& candidate : estimate_.candidates()) {
    SegmentReport segment;
    segment.sequence = candidate.segment.sequence;
    segment.begin_ns = candidate.segment.beginNs();
    segment.end_ns = candidate.segment.endNs();
    segment.entropy = candidate.entropy;
    segment.keyframes = static_cast<int>(candidate.segment.keyframes.size());
    segment.landmarks = static_cast<int>(candidate.segment.landmarks.size());
    segment.observations = static_cast<int>(candidate.segment.observations.size());
    report_.queue.segments.push_back(segment);
  }
}

}  // namespace camera_self_calibration
