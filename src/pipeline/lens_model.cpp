// Which model the lens follows: the part of BackEnd that compares models.

#include <utility>

#include "camera_self_calibration/pipeline/back_end.h"

namespace camera_self_calibration {

// Until the queue is the better estimate, on the startup batch: under a model that is far from the
// lens its segments fit none, and the queue stays empty. A model that was given stays, but what
// speaks against it is said, lest the motion be blamed.
void BackEnd::considerStartupModel() {
  if (queueLeads(state_.phase) || !state_.startup.comparable()) return;
  if (!state_.model_choice.isDue(state_.keyframesOfLens())) return;
  const LensComparison comparison = state_.lens_fit.compareStart(
      state_.startup.solved(), {state_.startup.camera(), state_.startup.covariance()}, state_.field,
      options_.solver_threads);
  if (state_.chooses_model) chooseModel(comparison);
}

// Ahead of every verdict, so that no lens is called CONVERGED that its model does not describe.
void BackEnd::considerLensFit() {
  if (!queueLeads(state_.phase)) return;
  const bool verdict_due = state_.health.state != CalibrationState::kConverged &&
                           state_.uncertainty().rms <= convergedRms();
  const auto comparison = compareLens(verdict_due);
  if (!comparison) return;
  const bool other = state_.chooses_model ? chooseModel(*comparison) : gainK3(*comparison);
  if (other) compareLens(true);
}

std::optional<LensComparison> BackEnd::compareLens(bool verdict_due) {
  auto comparison = state_.lens_fit.consider(
      state_.keyframesOfLens(), verdict_due, state_.queue.candidates(), state_.queue.solution(),
      {state_.field, state_.known.observed_area}, options_.solver_threads);
  if (comparison) {
    stateUncertainty();
    changed_ = true;
  }
  return comparison;
}

// Whether the lens in use is another one now.
bool BackEnd::chooseModel(const LensComparison& comparison) {
  const ModelChoice before = state_.model_choice;
  const std::optional<LensTrial> other =
      state_.model_choice.choose(comparison, state_.field, options_.solver_threads);
  if (!other) return false;
  if (switchModel(*other)) return true;
  state_.model_choice = before;
  return false;
}

// A given radtan gains k3 after hand-over, too, where startup's batch did not demand it. Whether it
// did.
bool BackEnd::gainK3(const LensComparison& comparison) {
  if (isStarting(state_.phase) || comparison.observations.segments.size() < 2) return false;
  for (const LensTrial& richer : comparison.richer) {
    if (!richer.usable || richer.camera.model() != comparison.present.camera.model()) continue;
    const LensKnowledge known =
        knowledgeOf(comparison.observations, richer, options_.solver_threads);
    const double p_value = leadByChance(richer, comparison.present, known);
    return p_value <= LensFitOptions().significance && switchModel(richer);
  }
  return false;
}

// The queue's segments stay, scored anew. After hand-over, if their joint estimate fails, all stays
// as it was: false.
bool BackEnd::switchModel(const LensTrial& lens) {
  std::vector<Candidate> candidates;
  for (const Candidate& candidate : state_.queue.candidates()) {
    const bool restored = candidate.observed.keyframes.empty();
    const Segment& observed = restored ? candidate.segment : candidate.observed;
    candidates.push_back(evaluateCandidate(CandidateOptions(), observed, lens.camera));
  }
  SegmentQueue queue = state_.queue;
  Shutter shutter = state_.shutter;
  shutter.solve(candidates, lens.camera, &queue);
  const bool starting = isStarting(state_.phase);
  if (!starting && !queue.solution().usable) return false;
  if (starting) state_.startup.switchModel(lens.camera, lens.segments);
  clearQueue();
  state_.watch.forgetWindows();  // what they said is of the other model's parameters
  state_.queue = std::move(queue);
  state_.shutter = std::move(shutter);
  state_.known = KnownLens();
  state_.known.camera = lens.camera;
  // It was said of another lens; the next verdict may say it again.
  if (state_.health.state == CalibrationState::kConverged) {
    state_.health.state = CalibrationState::kConverging;
  }
  if (starting) {
    followTheBetter();
  } else {
    adoptSolution();
  }
  return true;
}

}  // namespace camera_self_calibration
