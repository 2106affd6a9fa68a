// The verdict at the end of a keyframe, and what the back end tells the others.

#include <string>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/estimation/entropy.h"
#include "camera_self_calibration/pipeline/back_end.h"

namespace camera_self_calibration {
namespace {

std::string drifting(const LensDrift& drift) {
  return formatted("; the focal length drifts by some %.2g %% a minute", 100.0 * drift.rate);
}

}  // namespace

void BackEnd::judge() {
  if (phase_ == Phase::kHeld) {
    health_ = {CalibrationState::kConverged, "the intrinsics were given and are held", ""};
    return;
  }
  HealthEvidence evidence;
  evidence.keyframes = static_cast<int>(keyframes_);
  evidence.has_estimate = queueLeads(phase_) || startup_.usable();
  evidence.handed_over = !isStarting(phase_);
  evidence.information =
      queueLeads(phase_) ? queue_.solution().information : startup_.information();
  evidence.uncertainty = uncertainty();
  evidence.seeing_share = field_.share();
  evidence.threshold_px = convergedRms();
  evidence.epoch = counters_.epoch;
  evidence.obstacle = obstacle_;
  const LensFitReport& fit = lens_fit_.report();
  if (fit.misfit.rms > known_.noise.rms) evidence.better_model = fit.better;
  const bool was_converged = health_.state == CalibrationState::kConverged;
  health_ = judgeHealth(evidence, known_.camera, was_converged);
  const bool converged = health_.state == CalibrationState::kConverged;
  if (converged && !converged_told_) raise(EventType::kConverged, health_.sentence);
  converged_told_ = converged;
  const std::string choice = model_choice_.sentence();
  if (!choice.empty()) health_.sentence += "; " + choice;
  if (isStarting(phase_)) return;
  if (fit.compared) health_.sentence += "; " + fit.sentence();
  const LensDrift& drift = queue_.solution().drift;
  if (drift.significant) health_.sentence += drifting(drift);
}

BackEndOutput BackEnd::finish() {
  BackEndOutput output;
  if (changed_) {
    ++counters_.revision;
    output.update = update();
  }
  changed_ = false;
  output.events = std::exchange(events_, {});
  for (Event& event : output.events) event.epoch = counters_.epoch;
  output.report = report();
  return output;
}

void BackEnd::raise(EventType type, const std::string& sentence) {
  events_.push_back({type, stamp_ns_, stamp_ns_, sentence});
}

// Until a restored queue is confirmed the front end sends the whole history and ends no tracks for
// not fitting it.
CalibrationUpdate BackEnd::update() const {
  CalibrationUpdate update;
  update.camera = known_.camera;
  update.generation = counters_.revision;
  update.handed_over = phase_ == Phase::kHandedOver;
  update.uncertainty_px = uncertainty().rms;
  update.epoch = counters_.epoch;
  update.row_time_s = shutter_.rowTime().inUse();
  update.onset_ns = watch_.onsetNs();
  if (!queueLeads(phase_)) update.solution = startup_.segment();
  return update;
}

CalibrationReport BackEnd::report() const {
  CalibrationReport report;
  report.stamp_ns = stamp_ns_;
  report.state = health_.state;
  report.sentence = health_.sentence;
  report.hint = health_.hint;
  report.camera = known_.camera;
  report.covariance = known_.covariance;
  report.uncertainty = uncertainty();
  report.entropy = entropy(known_.camera, known_.covariance);
  report.revision = counters_.revision;
  report.epoch = counters_.epoch;
  report.change_p_value = change_p_value_;
  report.last_change = last_change_;
  report.handed_over = !isStarting(phase_);
  report.keyframes = keyframes_;
  report.queue = queueReport();
  report.shutter = shutter_.report();
  report.lens_fit = lens_fit_.report();
  report.models = model_choice_.evidence();
  return report;
}

QueueReport BackEnd::queueReport() const {
  QueueReport report;
  report.swaps = swaps_;
  report.last_accepted = outcome_.accepted;
  report.last_decision = outcome_.reason;
  for (const Candidate& candidate : queue_.candidates()) {
    SegmentReport segment;
    segment.sequence = candidate.segment.sequence;
    segment.begin_ns = candidate.segment.beginNs();
    segment.end_ns = candidate.segment.endNs();
    segment.entropy = candidate.entropy;
    segment.keyframes = static_cast<int>(candidate.segment.keyframes.size());
    segment.landmarks = static_cast<int>(candidate.segment.landmarks.size());
    segment.observations = static_cast<int>(candidate.segment.observations.size());
    report.segments.push_back(segment);
  }
  return report;
}

std::shared_ptr<const LearntState> BackEnd::state() const {
  if (isStarting(phase_) || phase_ == Phase::kHeld) return nullptr;
  auto state = std::make_shared<LearntState>();
  state->camera = known_.camera;
  state->state = health_.state;
  state->stamp_ns = stamp_ns_;
  state->keyframes = keyframes_;
  state->revision = counters_.revision;
  state->epoch = counters_.epoch;
  state->row_time_s = shutter_.rowTime().inUse();
  const RowTimeEstimate& row_time = shutter_.rowTime().estimate();
  if (row_time.usable) state->row_time_sigma_s = row_time.sigma_s;
  state->segments = queue_.candidates();
  return state;
}

}  // namespace camera_self_calibration
