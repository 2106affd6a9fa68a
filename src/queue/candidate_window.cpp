#include "camera_self_calibration/queue/candidate_window.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/estimation/entropy.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "camera_self_calibration/queue/segment_fit.h"

namespace camera_self_calibration {
namespace {

std::string illPosed(const CandidateOptions& options, const Candidate& candidate) {
  const int landmarks = static_cast<int>(candidate.segment.landmarks.size());
  if (landmarks < options.min_landmarks) {
    return formatted("only %d landmarks fit (needed: %d)", landmarks, options.min_landmarks);
  }
  if (candidate.residual_scale > options.max_residual_scale) {
    return formatted("residuals are %.1f times the tracker's sigma (accepted: up to %.1f)",
                     candidate.residual_scale, options.max_residual_scale);
  }
  const double smallest = scaledEigenvalues(candidate.information)(0);
  if (!(smallest > options.min_scaled_eigenvalue)) {
    return formatted("the intrinsics are not observable (scaled eigenvalue %.1e, needed: %.1e)",
                     smallest, options.min_scaled_eigenvalue);
  }
  const double limit = options.max_pixel_uncertainty_share * candidate.camera.longerSide();
  if (!(candidate.uncertainty.rms < limit)) {
    return formatted("the intrinsics are too uncertain (%.1f px rms, needed: %.1f)",
                     candidate.uncertainty.rms, limit);
  }
  if (!std::isfinite(candidate.entropy)) return "the covariance is not positive definite";
  return "";
}

}  // namespace

Candidate evaluateCandidate(const CandidateOptions& options, const Segment& segment,
                            const Camera& start) {
  Candidate candidate;
  candidate.observed = segment;
  candidate.segment = segment;
  candidate.camera = start;
  if (static_cast<int>(segment.keyframes.size()) < options.min_keyframes) {
    candidate.reason = formatted("%d keyframes (needed: %d)",
                                 static_cast<int>(segment.keyframes.size()), options.min_keyframes);
    return candidate;
  }
  SegmentFitOptions fit_options;
  fit_options.precision = kEstimatePrecision;
  fit_options.intrinsics_precision = 0.05;
  const SegmentFit fit = fitSegment(fit_options, &candidate.segment, &candidate.camera);
  if (!fit.usable) {
    candidate.reason = "no solution was found";
    return candidate;
  }
  candidate.residual_scale = fit.residual_scale;
  candidate.sigma_scale = fit.marginal.sigmaScale();
  candidate.information =
      fit.marginal.information / (candidate.sigma_scale * candidate.sigma_scale);
  SegmentBlock block = freeBlock(&candidate.segment, candidate.camera);
  block.sigma_scale = candidate.sigma_scale;
  candidate.cost = robustCost(block, candidate.camera, SegmentFitOptions().huber);
  const IntrinsicsMatrix covariance =
      covarianceFromInformation(candidate.information).value_or(IntrinsicsMatrix());
  candidate.entropy = entropy(candidate.camera, covariance);
  candidate.uncertainty = pixelUncertainty(candidate.camera, covariance);
  candidate.reason = illPosed(options, candidate);
  const double remaining = fit.marginal.remainingStep() / candidate.sigma_scale;
  if (candidate.reason.empty() && !(remaining < options.max_remaining_step)) {
    candidate.reason =
        formatted("the solution has not converged (last step %.1f sigma, accepted: up to %.1f)",
                  remaining, options.max_remaining_step);
  }
  candidate.well_posed = candidate.reason.empty();
  return candidate;
}

}  // namespace camera_self_calibration
