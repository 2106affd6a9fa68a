// Which model the lens follows: the part of BackEnd that compares models.

#include <utility>

#include "camera_self_calibration/pipeline/back_end.h"

namespace camera_self_calibration {

// Until the queue is the better estimate, on the startup batch: under a model that is far from the
// lens its segments fit none, and the queue stays empty.
void BackEnd::considerStartupModel() {
  if (options_.model || follows_queue_ || !startup_.comparable()) return;
  if (!model_choice_.isDue(report_.keyframes)) return;
  LensObservations observations{{startup_.solved()}, {1.0}};
  chooseModel(
      compareWithRicher(std::move(observations), startup_.camera(), options_.solver_threads));
}

// Ahead of every verdict, so that no lens is called CONVERGED that its model does not describe.
void BackEnd::considerLensFit() {
  if (!handed_over_ && !follows_queue_) return;
  const bool verdict_due =
      report_.state != CalibrationState::kConverged && noise_.rms <= convergedRms();
  const auto comparison =
      lens_fit_.consider(report_.keyframes, verdict_due, estimate_.candidates(), solution_,
                         {field_, observed_}, options_.solver_threads);
  if (!comparison) return;
  stateUncertainty();
  changed_ = true;
  if (!options_.model) chooseModel(*comparison);
}

void BackEnd::chooseModel(const LensComparison& comparison) {
  const std::optional<LensTrial> other =
      model_choice_.choose(comparison, field_, options_.solver_threads);
  report_.models = model_choice_.evidence();
  if (other) switchModel(*other);
}

// The queue's segments stay, scored anew; if their joint estimate fails, all stays as it was.
void BackEnd::switchModel(const LensTrial& lens) {
  std::vector<Segment> observed;
  for (const Candidate& candidate : estimate_.candidates()) {
    const bool restored = candidate.observed.keyframes.empty();
    observed.push_back(restored ? candidate.segment : candidate.observed);
  }
  BackEnd switched = *this;
  switched.clearQueue();
  switched.report_.camera = lens.camera;
  switched.report_.covariance = IntrinsicsMatrix();
  switched.report_.uncertainty = PixelError::unknown();
  for (const Segment& segment : observed) {
    switched.offer(evaluateCandidate(CandidateOptions(), segment, lens.camera));
  }
  if (!switched.estimate_.candidates().empty()) switched.solveQueue();
  if (handed_over_) {
    if (!switched.solution_.usable) return;
    // It was said of another lens; the next verdict may say it again.
    if (report_.state == CalibrationState::kConverged) {
      switched.report_.state = CalibrationState::kConverging;
    }
  } else {
    switched.startup_.switchModel(lens.camera, lens.segments);
    switched.followTheBetter();
  }
  switched.report_.queue.swaps = report_.queue.swaps;
  *this = switched;
}

}  // namespace camera_self_calibration
