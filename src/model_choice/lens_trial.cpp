#include "camera_self_calibration/model_choice/lens_trial.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "camera_self_calibration/base/distributions.h"
#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/queue/agreement.h"

namespace camera_self_calibration {
namespace {

// Another lens is near its optimum after some ten steps. A third of a sigma that is left to go
// changes the likelihood ratio by 0.1.
constexpr int kMaxIterations = 15;
constexpr double kSettled = 0.3;
// A fit is worth while where a lead that chance gives in 1 of 100 comparisons may come of it:
// promised to first order, the likelihood ratio may turn out twice as large.
constexpr double kByChance = 0.01;
constexpr double kWorthAFit = 0.5;
// Of the sigmas, that the residuals under another lens can make of them.
constexpr double kLeastShare = 1e-3;

double costOf(const Problem& problem) {
  double sum = 0.0;
  for (const SegmentBlock& block : problem.blocks) {
    sum += robustCost(block, *problem.camera, SolverOptions().huber);
  }
  return sum;
}

// equidistant follows fov to 0.05 px at worst, which no observation tells from containing it.
bool contains(const Camera& lens, const Camera& simpler) {
  return simpler.model() == CameraModel::kPinhole || simpler.model() == lens.model() ||
         (simpler.model() == CameraModel::kFov && lens.model() == CameraModel::kEquidistant);
}

int degreesOfFreedom(const Camera& behind, const Camera& ahead) {
  return std::max(1,
                  ahead.estimatedCount() - (contains(ahead, behind) ? behind.estimatedCount() : 0));
}

// Twice the log-likelihood that `other` can gain on a lens of this cost, to first order.
double promisedRatio(const LensObservations& observations, double present_cost, const Camera& other,
                     int threads) {
  std::vector<Segment> segments = observations.segments;
  Camera camera = other;
  const Problem problem = problemOf(observations, &segments, &camera);
  const Marginal marginal = marginalize(problem, SolverOptions().huber, threads);
  const double step = marginal.remainingStep();
  const double ratio = 2.0 * (present_cost - marginal.cost) + step * step;
  return ratio / std::max(1.0, marginal.designEffect());
}

// Whether a fit of `richer` is worth while. One that does not contain the present lens starts where
// it is no better, and its first step tells nothing: it is fitted.
bool promisesALead(const LensObservations& observations, const LensTrial& present,
                   const Camera& richer, int threads) {
  if (!contains(richer, present.camera)) return true;
  const double limit = chiSquareQuantile(degreesOfFreedom(present.camera, richer), kByChance);
  return promisedRatio(observations, present.cost, richer, threads) >= kWorthAFit * limit;
}

// How far the segments are from their joint lens, to first order.
Scatter scatterOf(const Marginal& marginal) {
  Scatter scatter;
  for (const BlockShare& share : marginal.shares) {
    scatter.chi_square += squaredDistance(share.gradient, share.information);
  }
  scatter.freedom = static_cast<int>((static_cast<Eigen::Index>(marginal.shares.size()) - 1) *
                                     marginal.gradient.size());
  return scatter.freedom > 0 ? scatter : Scatter();
}

}  // namespace

Problem problemOf(const LensObservations& observations, std::vector<Segment>* segments,
                  Camera* camera) {
  Problem problem;
  problem.camera = camera;
  for (std::size_t i = 0; i < segments->size(); ++i) {
    problem.blocks.push_back(freeBlock(&(*segments)[i], *camera));
    problem.blocks.back().sigma_scale = observations.sigma_scales[i];
  }
  return problem;
}

Scatter disagreement(const LensObservations& observations, const Scatter& own) {
  return own.birgeRatio() < observations.scatter.birgeRatio() ? own : observations.scatter;
}

LensObservations observationsOf(const std::vector<Candidate>& queue, const Scatter& scatter) {
  LensObservations observations;
  for (const Candidate& candidate : queue) {
    observations.segments.push_back(candidate.segment);
    observations.sigma_scales.push_back(candidate.sigma_scale);
  }
  observations.scatter = scatter;
  return observations;
}

std::string LensTrial::name() const {
  const bool with_k3 = camera.estimatedCount() == kMaxIntrinsics;
  return toString(camera.model()) + (with_k3 ? " with k3" : "");
}

LensTrial tryLens(const LensObservations& observations, const Camera& start, int threads) {
  LensTrial trial;
  trial.camera = start;
  trial.segments = observations.segments;
  const Problem problem = problemOf(observations, &trial.segments, &trial.camera);
  SolverOptions options;
  options.max_iterations = kMaxIterations;
  options.precision = kEstimatePrecision;
  options.intrinsics_precision = kSettled;
  options.threads = threads;
  trial.usable = solve(problem, options).usable && trial.camera.valid();
  trial.cost = trial.usable ? costOf(problem) : std::numeric_limits<double>::infinity();
  return trial;
}

LensKnowledge knowledgeOf(const LensObservations& observations, const LensTrial& trial,
                          int threads) {
  std::vector<Segment> segments = trial.segments;
  Camera camera = trial.camera;
  Problem problem = problemOf(observations, &segments, &camera);
  Marginal marginal = marginalize(problem, SolverOptions().huber, threads);
  // The sigmas cover what another lens, under which the tracks were gated, left unexplained.
  const double share = std::clamp(marginal.residualScale(), kLeastShare, 1.0);
  if (share < 1.0) {
    for (SegmentBlock& block : problem.blocks) block.sigma_scale *= share;
    marginal = marginalize(problem, SolverOptions().huber, threads);
  }
  const double scale = share * marginal.sigmaScale();
  const Scatter scatter = disagreement(observations, scatterOf(marginal));
  LensKnowledge knowledge;
  knowledge.variance = scatter.variance();
  knowledge.variance.factor *= scale * scale;
  if (const auto covariance = marginal.robustCovariance()) {
    knowledge.covariance = scatter.birgeRatio() * scatter.birgeRatio() * *covariance;
  }
  return knowledge;
}

std::optional<Camera> likewise(const Camera& camera, CameraModel model, bool with_k3) {
  const bool k3 = model == CameraModel::kRadtan && with_k3;
  Camera other = camera;
  if (camera.model() != model) {
    const std::optional<CameraFit> fit = fitCamera(camera, model);
    if (!fit || !std::isfinite(fit->error.rms)) return std::nullopt;
    other = fit->camera;
  }
  if (model == CameraModel::kRadtan) {
    const int count = Camera::parameterCount(model);
    if (!k3) other = Camera(model, other.width(), other.height(), other.parameters().head(count));
    other.setEstimateK3(k3);
  }
  return withLeastFovW(other);
}

double leadByChance(const LensTrial& ahead, const LensTrial& behind, const LensKnowledge& known) {
  if (!behind.usable) return ahead.usable ? 0.0 : 1.0;
  const double ratio = 2.0 * (behind.cost - ahead.cost);
  if (!(ratio / known.variance.factor > 0.0)) return 1.0;
  return known.variance.exceedance(ratio, degreesOfFreedom(behind.camera, ahead.camera));
}

double shareBeyondChance(const LensTrial& ahead, const LensTrial& behind,
                         const LensKnowledge& known) {
  if (!behind.usable) return ahead.usable ? 1.0 : 0.0;
  const double ratio = 2.0 * (behind.cost - ahead.cost) / known.variance.factor;
  const double by_chance = degreesOfFreedom(behind.camera, ahead.camera);
  return ratio > by_chance ? 1.0 - by_chance / ratio : 0.0;
}

std::int64_t nextComparison(std::int64_t keyframes) {
  constexpr std::int64_t kMinInterval = 5;
  constexpr std::int64_t kMaxInterval = 100;
  return keyframes + std::clamp(keyframes / 4, kMinInterval, kMaxInterval);
}

LensComparison compareWithRicher(LensObservations observations, const Camera& present,
                                 int threads) {
  LensComparison comparison;
  comparison.present = tryLens(observations, present, threads);
  observations.segments = comparison.present.segments;
  for (const CameraModel model : {CameraModel::kRadtan, CameraModel::kEquidistant}) {
    const std::optional<Camera> richer = likewise(comparison.present.camera, model, true);
    if (!richer) continue;
    const Camera& camera = comparison.present.camera;
    if (model == camera.model() && richer->estimatedCount() == camera.estimatedCount()) continue;
    if (!promisesALead(observations, comparison.present, *richer, threads)) continue;
    comparison.richer.push_back(tryLens(observations, *richer, threads));
  }
  comparison.observations = std::move(observations);
  return comparison;
}

}  // namespace camera_self_calibration
