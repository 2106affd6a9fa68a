#include "camera_self_calibration/pipeline/lens_watch.h"

namespace camera_self_calibration {
namespace {

// The batch does not allow for errors that are correlated along tracks: its sigma counts as so many
// times as large.
constexpr double kStartupSigmas = 2.0;
constexpr std::size_t kCourse = 20;  // keyframes
// Times the limit of CONVERGED that it has to be good to for a contradiction to be a change of the
// lens. Of the first lens it may be too sure by much at first, as the scene is not known either.
constexpr double kToldFirstLens = 0.5;
constexpr double kToldLens = 2.0;

}  // namespace

std::optional<double> LensWatch::clearlySame(const KeyframeMessage& message,
                                             const CandidateOutlook& outlook,
                                             const SegmentQueue& queue, bool handed_over) {
  if (handed_over) return detector_.clearlySame(outlook, message.suspected_onset_ns, queue);
  // Each window is held against what the batch said before it.
  if (!course_.empty() || !fitsAsUsual(outlook.sigma_scale, queue)) return std::nullopt;
  return 1.0;
}

ChangeVerdict LensWatch::examine(const KeyframeMessage& message, const Candidate& candidate,
                                 const SegmentQueue& queue, bool handed_over) {
  if (handed_over) {
    return detector_.examine(message.candidate, candidate, message.suspected_onset_ns, queue);
  }
  const std::optional<Reference> known = knownBefore(message.candidate.beginNs());
  if (!known) return ChangeVerdict();
  return detector_.examineUnfinished(message.candidate, candidate, *known, residual_scale_);
}

void LensWatch::remember(std::int64_t stamp_ns, const Startup& startup,
                         const PixelError& uncertainty, double converged_rms) {
  if (!(uncertainty.rms < (first_lens_ ? kToldFirstLens : kToldLens) * converged_rms)) return;
  const double sigmas = kStartupSigmas * usual_scatter_.birgeRatio();
  course_.emplace_back(
      stamp_ns,
      Reference{startup.camera(), startup.information() / (sigmas * sigmas), usual_scatter_});
  if (course_.size() > kCourse) course_.pop_front();
  residual_scale_ = startup.residualScale();
}

std::optional<Reference> LensWatch::knownBefore(std::int64_t stamp_ns) const {
  std::optional<Reference> newest;
  for (const auto& [known_at_ns, reference] : course_) {
    if (known_at_ns < stamp_ns) newest = reference;
  }
  return newest;
}

void LensWatch::forgetStamps() {
  onset_ns_ = 0;
  forgetStartup();
  forgetWindows();
}

void LensWatch::beginLens(std::int64_t onset_ns, const std::optional<Scatter>& scatter) {
  onset_ns_ = onset_ns;
  first_lens_ = false;
  if (scatter) usual_scatter_ = *scatter;
  course_.clear();
  detector_.reset();
}

}  // namespace camera_self_calibration
