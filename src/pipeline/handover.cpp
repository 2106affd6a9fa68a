// From the startup batch to the queue: the part of BackEnd that works until hand-over.

#include <string>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/estimation/entropy.h"
#include "camera_self_calibration/pipeline/back_end.h"

namespace camera_self_calibration {
namespace {

// Distance of the queue's estimate from the startup batch's, over the sum of their uncertainties,
// beyond which one of them is wrong.
constexpr double kMaxStartupDistance = 4.0;

}  // namespace

void BackEnd::runStartup(const KeyframeMessage& message) {
  startup_.add(message.history);
  if (startup_.usable() && (report_.camera.estimatedCount() != startup_.camera().estimatedCount() ||
                            report_.camera.model() != startup_.camera().model())) {
    clearQueue();  // its segments were scored for other parameters
  }
  followTheBetter();
  considerStartupModel();
}

// The batch forgets: it begins anew in every map, and in fast motion leaves out the oldest
// keyframes. The queue does not.
void BackEnd::followTheBetter() {
  const QueueStanding queue = queueStanding();
  const bool believed = queue.doubt.empty();
  if (believed) startup_.beginNextFrom(solution_.camera, solution_.covariance);
  follows_queue_ = believed && !(queue.startup_uncertainty.rms <= queue.uncertainty.rms);
  if (follows_queue_) {
    adoptSolution();
  } else if (startup_.usable()) {
    // Intrinsics that nothing told would only do harm in front.
    if (startup_.tellsLens()) changed_ = true;
    adoptStartup(queue.startup_uncertainty);
  }
}

void BackEnd::adoptStartup(const PixelError& uncertainty) {
  report_.camera = startup_.heldCamera();
  report_.covariance = startup_.covariance();
  report_.uncertainty = uncertainty;
  report_.entropy = entropy(report_.camera, report_.covariance);
}

PixelError BackEnd::startupUncertainty() const {
  return startup_.usable() ? pixelUncertainty(startup_.camera(), startup_.covariance(), field_)
                           : PixelError::unknown();
}

BackEnd::QueueStanding BackEnd::queueStanding() const {
  QueueStanding queue;
  queue.startup_uncertainty = startupUncertainty();
  if (solution_.usable) {
    queue.uncertainty = pixelUncertainty(solution_.camera, solution_.covariance, field_);
  }
  double distance = 0.0;
  if (startup_.tellsLens() && solution_.usable) {
    distance = pixelDistance(solution_.camera, startup_.camera(), field_).rms;
    const double expected = queue.startup_uncertainty.rms + queue.uncertainty.rms;
    queue.contradicts_startup = !(distance <= kMaxStartupDistance * expected);
  }
  const std::size_t stretches = estimate_.candidates().size();
  if (stretches < 2 || !solution_.usable) {
    queue.doubt = "two separate stretches of video are not there yet";
  } else if (stretches < 3 && solution_.scatter.inflationFreedom() > 0) {
    queue.doubt = "the two separate stretches disagree: a third has to tell which is right";
  } else if (queue.contradicts_startup) {
    queue.doubt = formatted(
        "the separate stretches and the whole are %.1f px rms apart, at most %.0f times their "
        "uncertainty is believed",
        distance, kMaxStartupDistance);
  } else if (solution_.scatter.inflation() > kMaxInflation) {
    queue.doubt = formatted(
        "the stretches disagree by %.1f times their uncertainty, at most %.1f is believed",
        solution_.scatter.inflation(), kMaxInflation);
  }
  return queue;
}

void BackEnd::considerHandover(std::int64_t stamp_ns, std::vector<Event>* events) {
  const double threshold = 2.0 * convergedRms();
  const QueueStanding queue = queueStanding();
  obstacle_ = queue.doubt;
  if (queue.contradicts_startup && queue.startup_uncertainty.rms < threshold) {
    clearQueue();  // filled from a start that was wrong
  }
  if (!obstacle_.empty() || !startup_.usable()) return;
  if (!(queue.uncertainty.rms < threshold ||
        entropy(solution_.camera, solution_.covariance) < options_.handover_entropy)) {
    obstacle_ = formatted(
        "the stretches of video together are good to %.2f px rms, less than %.2f px is needed",
        queue.uncertainty.rms, threshold);
    return;
  }
  handed_over_ = true;
  report_.handed_over = true;
  adoptSolution();
  events->push_back(
      {EventType::kHandover, stamp_ns, stamp_ns,
       formatted("the calibration now rests on several stretches of video (the queue), good to "
                 "%.2f px rms (limit %.2f px)",
                 report_.uncertainty.rms, threshold)});
}

}  // namespace camera_self_calibration
