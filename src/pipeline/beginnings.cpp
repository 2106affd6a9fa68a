// How the back end begins, and begins again: from nothing, from a saved queue, with another lens.

#include <algorithm>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/pipeline/back_end.h"

namespace camera_self_calibration {
namespace {

StartupOptions startupOptions(const Options& options) {
  StartupOptions startup;
  startup.max_keyframes = options.startup_keyframes;
  return startup;
}

std::string describe(const Event& event) {
  return formatted(": by %.2f px rms over the image, noticed after %.1f s", event.magnitude_px,
                   1e-9 * static_cast<double>(event.stamp_ns - event.onset_stamp_ns));
}

}  // namespace

BackEnd::BackEnd(const Options& options, const Camera& camera, const Counters& counters)
    : options_(options),
      startup_(startupOptions(options), camera),
      queue_(QueuePolicy(options.queue_segments, options.alpha, options.score),
             options.solver_threads),
      shutter_(options, camera.height()),
      watch_(options.false_alarms_per_hour),
      model_choice_(ModelChoiceOptions()),
      lens_fit_(LensFitOptions()),
      counters_(counters),
      changed_(counters.revision > 0) {  // what was known before is no longer in use
  known_.camera = camera;
  if (options.fix_intrinsics) {
    phase_ = Phase::kHeld;
    known_.noise = {0.0, 0.0};
    changed_ = false;
  }
}

bool BackEnd::restore(const LearntState& state) {
  const Camera& own = known_.camera;
  const bool same_model = options_.choose_model || state.camera.model() == own.model();
  if (phase_ == Phase::kHeld || !state.problems().empty() || !same_model ||
      state.camera.width() != own.width() || state.camera.height() != own.height()) {
    return false;
  }
  Shutter shutter = shutter_;
  shutter.restore(state);
  std::vector<Candidate> freed;
  for (const Candidate& candidate : state.segments) {
    freed.push_back(shutter.freed(candidate, state.camera));
  }
  SegmentQueue queue = queue_;
  const int taken = queue.rebuild(freed, shutter.startFrom(state.camera));
  if (!queue.solution().usable) return false;
  shutter_ = std::move(shutter);
  queue_ = std::move(queue);
  phase_ = Phase::kRestored;
  stamp_ns_ = state.stamp_ns;
  keyframes_ = state.keyframes;
  counters_ = {std::max(counters_.revision, state.revision), state.epoch};
  health_.state = state.state;  // CONVERGED is left on a change or a reset only
  outcome_.reason = "restored";
  adoptChange(taken);
  return true;
}

BackEndOutput BackEnd::confirm(const std::vector<Candidate>& candidates) {
  advance(PhaseTrigger::kConfirmed);
  std::vector<Candidate> comparable;
  for (const Candidate& candidate : candidates) {
    if (candidate.information.rows() != known_.camera.estimatedCount()) continue;
    comparable.push_back(shutter_.freed(candidate, known_.camera));
  }
  const int taken = queue_.offer(comparable, queueStart());
  if (taken > 0) adoptChange(taken);
  changed_ = true;
  judge();
  return finish();
}

// The present estimate goes on from what the alarm knows; the map, the poses and the queue of the
// epoch that ends keep their intrinsics.
BackEnd::CandidateOutcome BackEnd::beginLens(const ChangeVerdict& verdict) {
  archiveQueue(verdict.onset_ns);
  const QueueSolution before = queue_.solution();
  const bool by_queue = phase_ == Phase::kHandedOver && before.usable;
  Event event{EventType::kCalibrationChange, stamp_ns_, verdict.onset_ns, verdict.reason};
  // The camera in use may have followed the change already, as a drift.
  event.magnitude_px = pixelDistance(by_queue ? before.camera : known_.camera, verdict.camera).rms;
  event.p_value = verdict.p_value;
  event.sentence += describe(event);
  last_change_ = event.sentence;
  events_.push_back(std::move(event));

  advance(PhaseTrigger::kLensChanged);
  ++counters_.epoch;
  health_.state = CalibrationState::kInitializing;
  watch_.beginLens(verdict.onset_ns,
                   by_queue ? std::optional<Scatter>(before.scatter) : std::nullopt);
  const IntrinsicsMatrix covariance_before = by_queue ? before.covariance : startup_.covariance();
  startup_.resume(verdict.camera, verdict.information, verdict.segment, covariance_before);
  clearQueue();
  adoptStartup(startupUncertainty(startup_, field_));
  adoptChange(queue_.offer(verdict.recent, queueStart()));
  changed_ = true;
  return {false, "the queue of the lens before the change was archived"};
}

// As it was before the change, for a setting that returns.
void BackEnd::archiveQueue(std::int64_t onset_ns) {
  std::vector<std::int64_t> later;
  for (const Candidate& candidate : queue_.candidates()) {
    if (candidate.segment.endNs() >= onset_ns) later.push_back(candidate.segment.sequence);
  }
  if (queue_.solution().usable && !later.empty()) {
    queue_.exchange(later, {}, {queue_.solution().camera});
  }
  settings_.store({counters_.epoch, queue_});
}

}  // namespace camera_self_calibration
