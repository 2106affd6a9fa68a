#include "camera_self_calibration/pipeline/handover.h"

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/estimation/entropy.h"

namespace camera_self_calibration {
namespace {

// Distance of the queue's estimate from the startup batch's, over the sum of their uncertainties,
// beyond which one of them is wrong.
constexpr double kMaxStartupDistance = 4.0;

std::string doubtOf(const SegmentQueue& queue, const QueueStanding& standing, double distance_px) {
  const std::size_t segments = queue.candidates().size();
  const Scatter& scatter = queue.solution().scatter;
  if (segments < 2 || !queue.solution().usable) {
    return "two segments of video that do not overlap are needed";
  }
  if (segments < 3 && scatter.birgeFreedom() > 0) {
    return "the first two segments disagree; a third will decide";
  }
  if (standing.contradicts_startup) {
    return formatted(
        "the segments and the startup batch disagree by %.1f px rms, more than %.0f times their "
        "uncertainty",
        distance_px, kMaxStartupDistance);
  }
  if (scatter.birgeRatio() > kMaxBirgeRatio) {
    return formatted("the segments disagree by %.1f times their uncertainty (accepted: up to %.1f)",
                     scatter.birgeRatio(), kMaxBirgeRatio);
  }
  return "";
}

}  // namespace

PixelError startupUncertainty(const Startup& startup, const ImageField& field) {
  if (!startup.usable() || field.share() == 1.0) return startup.wholeImageUncertainty();
  return pixelUncertainty(startup.camera(), startup.covariance(), field);
}

QueueStanding queueStanding(const Startup& startup, const SegmentQueue& queue,
                            const ImageField& field) {
  const QueueSolution& solution = queue.solution();
  QueueStanding standing;
  standing.startup_uncertainty = startupUncertainty(startup, field);
  if (solution.usable) {
    standing.uncertainty = pixelUncertainty(solution.camera, solution.covariance, field);
  }
  double distance_px = 0.0;
  if (startup.isInformative() && solution.usable) {
    distance_px = pixelDistance(solution.camera, startup.camera(), field).rms;
    const double expected = standing.startup_uncertainty.rms + standing.uncertainty.rms;
    standing.contradicts_startup = !(distance_px <= kMaxStartupDistance * expected);
  }
  standing.doubt = doubtOf(queue, standing, distance_px);
  standing.unchecked =
      solution.usable && queue.candidates().size() == 1 && !standing.contradicts_startup;
  return standing;
}

PhaseTrigger betterEstimate(const Startup& startup, const QueueStanding& standing,
                            const HandoverLimits& limits) {
  // What is vague may be a wrong minimum.
  const bool enough = standing.unchecked && standing.uncertainty.rms < limits.pixel_rms;
  const bool leads = standing.doubt.empty() || (enough && !startup.isInformative());
  if (leads && !(standing.startup_uncertainty.rms <= standing.uncertainty.rms)) {
    return PhaseTrigger::kQueueBetter;
  }
  return startup.isInformative() ? PhaseTrigger::kStartupBetter : PhaseTrigger::kUninformed;
}

std::string shortfall(const QueueStanding& standing, const QueueSolution& solution,
                      const HandoverLimits& limits) {
  if (standing.uncertainty.rms < limits.pixel_rms ||
      entropy(solution.camera, solution.covariance) < limits.entropy) {
    return "";
  }
  return formatted("the segments of video together are good to %.2f px rms (needed: %.2f px)",
                   standing.uncertainty.rms, limits.pixel_rms);
}

}  // namespace camera_self_calibration
