// How the back end begins, and begins again: from nothing, from a saved queue, with another lens.

#include <algorithm>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/pipeline/back_end.h"
#include "camera_self_calibration/pipeline/handover.h"

namespace camera_self_calibration {
namespace {

StartupOptions startupOptions(const Options& options) {
  StartupOptions startup;
  startup.max_keyframes = options.startup_keyframes;
  startup.choose_model = !options.model;
  startup.threads = options.solver_threads;
  return startup;
}

std::string describe(const Event& event) {
  return formatted(" by %.2f px rms over the image; detected after %.1f s", event.magnitude_px,
                   toSeconds(event.stamp_ns - event.onset_stamp_ns));
}

}  // namespace

BackEndState::BackEndState(const Options& options, const Camera& camera)
    : chooses_model(!options.model),
      segment_keyframes(options.segment_keyframes),
      startup(startupOptions(options), camera),
      queue(QueuePolicy(options.queue_segments, options.alpha, options.score),
            options.solver_threads),
      shutter(options, camera.height()),
      watch(options.false_alarms_per_hour),
      model_choice(ModelChoiceOptions()),
      lens_fit(LensFitOptions()) {
  known.camera = camera;
  if (!options.fix_intrinsics) return;
  phase = Phase::kHeld;
  known.noise = {0.0, 0.0};
}

BackEnd::BackEnd(const Options& options, const Camera& camera, const Counters& counters)
    : options_(options), state_(options, camera) {
  state_.counters = counters;
  const bool held = state_.phase == Phase::kHeld;
  changed_ = !held && counters.revision > 0;  // what was known before is no longer in use
  converged_told_ = held;
}

bool BackEnd::restore(const LearntState& state) {
  const Camera& own = state_.known.camera;
  const bool same_model = state_.chooses_model || state.camera.model() == own.model();
  if (state_.phase != Phase::kNothingKnown || !state.problems().empty() || !same_model ||
      state.camera.width() != own.width() || state.camera.height() != own.height()) {
    return false;
  }
  Shutter shutter = state_.shutter;
  shutter.restore(state);
  SegmentQueue queue = state_.queue;
  const int taken = shutter.solve(state.segments, state.camera, &queue);
  if (!queue.solution().usable) return false;
  state_.shutter = std::move(shutter);
  state_.queue = std::move(queue);
  advance(PhaseTrigger::kRestored);
  state_.stamp_ns = state.stamp_ns;
  state_.keyframes = state.keyframes;
  state_.counters = {std::max(state_.counters.revision, state.revision), state.epoch};
  state_.health.state = state.state;  // where the limit for leaving CONVERGED is another one
  state_.outcome.reason = "restored";
  adoptChange(taken);
  return true;
}

BackEndOutput BackEnd::confirm(const std::vector<Candidate>& candidates) {
  advance(PhaseTrigger::kConfirmed);
  std::vector<Candidate> comparable;
  for (const Candidate& candidate : candidates) {
    const bool same_parameters =
        candidate.camera.model() == state_.known.camera.model() &&
        candidate.information.rows() == state_.known.camera.estimatedCount();
    if (!same_parameters) continue;
    comparable.push_back(state_.shutter.freed(candidate, state_.known.camera));
  }
  const int taken = state_.queue.offer(comparable, queueStart());
  if (taken > 0) adoptChange(taken);
  changed_ = true;
  judge();
  return finish();
}

// The present estimate goes on from what the alarm knows; the map, the poses and the queue of the
// epoch that ends keep their intrinsics.
CandidateOutcome BackEnd::beginLens(const ChangeVerdict& verdict) {
  QueueSolution before = state_.queue.solution();
  archiveQueue(verdict.onset_ns);
  // Without the segments that the present lens has a part in, where others are left.
  if (state_.queue.solution().usable) before = state_.queue.solution();
  const bool by_queue = state_.phase == Phase::kHandedOver && before.usable;
  Event event{EventType::kCalibrationChange, state_.stamp_ns, verdict.onset_ns, verdict.reason};
  // The camera in use may have followed the change already, as a drift.
  event.magnitude_px =
      pixelDistance(by_queue ? before.camera : state_.known.camera, verdict.camera).rms;
  event.p_value = verdict.p_value;
  event.sentence += describe(event);
  state_.last_change = event.sentence;
  state_.last_change_ns = event.onset_stamp_ns;
  events_.push_back(std::move(event));

  advance(PhaseTrigger::kLensChanged);
  ++state_.counters.epoch;
  state_.earlier_keyframes = state_.keyframes;
  state_.maps = 1;
  state_.longest_map = 0;
  state_.health.state = CalibrationState::kInitializing;
  converged_told_ = false;  // the event above says it
  state_.model_choice = ModelChoice(ModelChoiceOptions());
  state_.watch.beginLens(verdict.onset_ns,
                         by_queue ? std::optional<Scatter>(before.scatter) : std::nullopt);
  const IntrinsicsMatrix covariance_before =
      by_queue ? before.covariance : state_.startup.covariance();
  state_.startup.resume(verdict.camera, verdict.information, verdict.segment, covariance_before);
  clearQueue();
  adoptStartup(startupUncertainty(state_.startup, state_.field));
  adoptChange(state_.queue.offer(verdict.recent, queueStart()));
  changed_ = true;
  return {false, "the queue from before the change was archived"};
}

// As it was before the change, for a setting that returns.
void BackEnd::archiveQueue(std::int64_t onset_ns) {
  std::vector<std::int64_t> later;
  for (const Candidate& candidate : state_.queue.candidates()) {
    if (candidate.segment.endNs() >= onset_ns) later.push_back(candidate.segment.sequence);
  }
  if (state_.queue.solution().usable && !later.empty()) {
    state_.queue.exchange(later, {}, {state_.queue.solution().camera});
  }
  state_.settings.store({state_.counters.epoch, state_.queue});
}

}  // namespace camera_self_calibration
