#include "camera_self_calibration/queue/candidate_outlook.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/estimation/entropy.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/solver.h"

namespace camera_self_calibration {
namespace {

// By how much, as a share of all sigmas, a score may improve when poses and depths settle. Solved
// windows: at most 1 %.
constexpr double kSettlingShare = 0.02;
// Sigma scale, over that of the queue's segments, of a window that fits as well as usual.
constexpr double kUsualMisfit = 1.5;

}  // namespace

CandidateOutlook outlookOf(const Segment& segment, const Camera& camera) {
  CandidateOutlook outlook;
  if (segment.observations.empty()) return outlook;
  Segment copy = segment;
  Camera held = camera;
  const Problem problem{&held, true, {freeBlock(&copy, camera)}};
  const Marginal marginal = marginalize(problem, SolverOptions().huber);
  const auto covariance = covarianceFromInformation(marginal.information);
  if (!covariance) return outlook;
  const int count = camera.estimatedCount();
  outlook.best.sequence = segment.sequence;
  outlook.best.begin_ns = segment.beginNs();
  outlook.best.end_ns = segment.endNs();
  outlook.best.information = marginal.information;
  outlook.best.entropy = entropy(camera, *covariance) - count * kSettlingShare;
  outlook.best.pixel_rms = (1.0 - kSettlingShare) * pixelUncertainty(camera, *covariance).rms;
  outlook.sigma_scale = marginal.sigmaScale();
  const double weight = 1.0 / (outlook.sigma_scale * outlook.sigma_scale);
  outlook.likelihood = {segment.beginNs(), segment.endNs(), camera.parameters().head(count),
                        weight * marginal.gradient, weight * marginal.information};
  outlook.usable = std::isfinite(outlook.best.entropy) && std::isfinite(outlook.sigma_scale);
  return outlook;
}

bool fitsAsUsual(double sigma_scale, const SegmentQueue& queue) {
  std::vector<double> scales;
  for (const Candidate& candidate : queue.candidates()) scales.push_back(candidate.sigma_scale);
  return sigma_scale <= kUsualMisfit * std::max(1.0, median(std::move(scales), 1.0));
}

}  // namespace camera_self_calibration
