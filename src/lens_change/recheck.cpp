#include "camera_self_calibration/lens_change/recheck.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "camera_self_calibration/base/distributions.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/queue/segment_fit.h"

namespace camera_self_calibration {
namespace {

// How much worse than free intrinsics the known ones explain the segment; nothing (not a number)
// where one of the fits fails.
double likelihoodRatio(const Segment& segment, const Camera& fresh, const Camera& known) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  Segment free_segment = segment;
  Camera free_camera = fresh;
  if (!fitSegment(SegmentFitOptions(), &free_segment, &free_camera).usable) return kUnknown;
  SegmentFitOptions options = comparableFits();
  Segment held_segment = free_segment;
  Camera held_camera = known;
  const SegmentFit free = fitSegment(options, &free_segment, &free_camera);
  options.estimate_intrinsics = false;
  const SegmentFit held = fitSegment(options, &held_segment, &held_camera);
  if (!free.usable) return kUnknown;
  const double scale = free.marginal.sigmaScale();
  return 2.0 * (held.marginal.cost - free.marginal.cost) / (scale * scale);
}

}  // namespace

Recheck recheckCalibration(const RecheckOptions& options, const RecheckEvidence& evidence,
                           const Segment& segment) {
  Recheck result;
  result.sentence = "the new images do not tell enough of the lens yet";
  if (static_cast<int>(segment.keyframes.size()) < options.min_keyframes) return result;
  if (!(evidence.fresh_error.rms < 2.0 * evidence.threshold_px)) return result;
  result.distance_px = pixelDistance(evidence.known, evidence.fresh, evidence.field).rms;
  const double expected = std::hypot(evidence.known_error.rms, evidence.fresh_error.rms);
  const double limit =
      std::max(options.thresholds * evidence.threshold_px, options.sigmas * expected);
  if (result.distance_px <= limit) {
    // A vague estimate is near to everything.
    if (evidence.fresh_error.rms > 0.5 * evidence.threshold_px) return result;
    result.verdict = RecheckVerdict::kSame;
    result.sentence = formatted("%.2f px rms from what the new images say (expected: %.2f px)",
                                result.distance_px, expected);
    return result;
  }
  result.likelihood_ratio = likelihoodRatio(segment, evidence.fresh, evidence.known);
  const int parameters = std::max(evidence.fresh.estimatedCount(), evidence.known.estimatedCount());
  if (result.likelihood_ratio > chiSquareQuantile(parameters, options.false_alarm)) {
    result.verdict = RecheckVerdict::kDifferent;
    result.sentence = formatted(
        "%.2f px rms from what the new images say (expected: %.2f px; likelihood ratio %.0f)",
        result.distance_px, expected, result.likelihood_ratio);
    return result;
  }
  result.sentence = "the new images contradict themselves; more are needed";
  return result;
}

}  // namespace camera_self_calibration
