#include "camera_self_calibration/queue/agreement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "camera_self_calibration/base/decompositions.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/linear_segments.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/solver.h"

namespace camera_self_calibration {
namespace {

// Of one block at its present state.
QuadraticLikelihood linearized(const SegmentBlock& block, const Camera& camera) {
  const int count = camera.estimatedCount();
  LinearSegments only(1);
  LinearSegment& linear = only[0];
  linear.linearize(block, camera, count, SolverOptions().huber);
  linear.eliminate(0.0);
  return {block.segment->beginNs(), block.segment->endNs(), camera.parameters().head(count),
          linear.reducedGradient(), linear.reducedHessian()};
}

Intrinsics estimated(const Camera& camera) {
  return camera.parameters().head(camera.estimatedCount());
}

double squared(double value) { return value * value; }

// Sums of gradient and information at the reference, with its Birge ratio.
QuadraticLikelihood pooled(const std::vector<QuadraticLikelihood>& likelihoods,
                           const Reference& reference) {
  const Intrinsics point = estimated(reference.camera);
  QuadraticLikelihood sum;
  sum.point = point;
  sum.gradient.setZero(point.size());
  sum.information.setZero(point.size(), point.size());
  for (const QuadraticLikelihood& one : likelihoods) {
    if (one.point.size() != point.size()) continue;
    sum.gradient += one.gradientAt(point);
    sum.information += one.information;
  }
  const double weight = 1.0 / squared(reference.scatter.birgeRatio());
  sum.gradient *= weight;
  sum.information *= weight;
  return sum;
}

// The sum of two informations, factorised with a unit diagonal.
struct Total {
  Eigen::VectorXd scale;
  Eigen::LDLT<Eigen::MatrixXd> factor;

  explicit Total(const Eigen::MatrixXd& information)
      : scale(information.diagonal().unaryExpr(&inverseRoot)),
        factor(scale.asDiagonal() * information * scale.asDiagonal()) {}
};

}  // namespace

double squaredDistance(const Intrinsics& gradient, const IntrinsicsMatrix& information) {
  return gradient.dot(leastNormSolution(information, gradient).x.col(0));
}

QuadraticLikelihood ownLikelihood(const Candidate& candidate) {
  const int count = candidate.camera.estimatedCount();
  return {candidate.segment.beginNs(), candidate.segment.endNs(),
          candidate.camera.parameters().head(count), Intrinsics::Zero(count),
          candidate.information};
}

std::optional<QuadraticLikelihood> likelihoodAt(const Camera& camera, const Segment& segment,
                                                double sigma_scale) {
  Segment copy = segment;
  Camera held = camera;
  Problem problem{&held, false, {freeBlock(&copy, camera)}};
  problem.blocks[0].sigma_scale = sigma_scale;
  SolverOptions options;
  options.precision = kEstimatePrecision;
  if (!solve(problem, options).usable) return std::nullopt;
  const QuadraticLikelihood likelihood = linearized(problem.blocks[0], camera);
  if (!likelihood.gradient.allFinite() || !likelihood.information.allFinite()) return std::nullopt;
  return likelihood;
}

std::optional<Reference> referenceWithout(std::int64_t begin_ns, std::int64_t end_ns,
                                          const SegmentQueue& queue) {
  const QueueSolution& solution = queue.solution();
  if (!solution.usable) return std::nullopt;
  const int count = solution.camera.estimatedCount();
  // Of the rest, at the joint optimum.
  IntrinsicsMatrix information = squared(solution.scatter.birgeRatio()) * solution.information;
  Intrinsics gradient = Intrinsics::Zero(count);
  double chi_square = 0.0;
  int kept = 0;
  for (std::size_t i = 0; i < solution.shares.size(); ++i) {
    const Segment& segment = queue.candidates()[i].segment;
    const BlockShare& share = solution.shares[i];
    if (segment.endNs() < begin_ns || segment.beginNs() > end_ns) {
      ++kept;
      chi_square += squaredDistance(share.gradient, share.information);
      continue;
    }
    information -= share.information;
    gradient -= share.gradient;
  }
  const auto covariance = covarianceFromInformation(information);
  if (kept == 0 || !covariance) return std::nullopt;
  Reference reference{solution.camera, information, solution.scatter};
  const Intrinsics step = *covariance * gradient;
  reference.camera = withEstimated(solution.camera, estimated(solution.camera) + step);
  if (!reference.camera.valid()) return std::nullopt;
  // One that is tested must not be excused by what an earlier version of itself disagreed.
  if (kept > 1 && kept < static_cast<int>(solution.shares.size())) {
    chi_square = std::clamp(chi_square - gradient.dot(step), 0.0, solution.scatter.chi_square);
    reference.scatter = {chi_square, count * (kept - 1)};
  }
  reference.information /= squared(reference.scatter.birgeRatio());
  return reference;
}

Agreement agreement(const std::vector<QuadraticLikelihood>& likelihoods,
                    const Reference& reference) {
  const QuadraticLikelihood sum = pooled(likelihoods, reference);
  // (I_o^-1 + I_r^-1)^-1 = I_o - I_o (I_o + I_r)^-1 I_o, and I_o d is the gradient: no inverse of
  // I_o is needed, which may be singular.
  const Total total(sum.information + reference.information);
  const Eigen::VectorXd& scale = total.scale;
  const Eigen::MatrixXd own = scale.asDiagonal() * sum.information * scale.asDiagonal();
  const Eigen::VectorXd g = scale.cwiseProduct(sum.gradient);
  // T^2 = g^T (I_o + I_o I_r^-1 I_o)^-1 g on the range of I_o.
  const Eigen::MatrixXd inner = own - own * total.factor.solve(own);
  const Eigen::VectorXd d = leastNormSolution(own, g).x;
  Agreement result;
  result.statistic = std::max(0.0, d.dot(inner * d));
  if (!std::isfinite(result.statistic)) result.statistic = 0.0;
  result.p_value = pValue(result.statistic, reference);
  return result;
}

Intrinsics compromise(const std::vector<QuadraticLikelihood>& likelihoods,
                      const Reference& reference) {
  const QuadraticLikelihood sum = pooled(likelihoods, reference);
  const Total total(sum.information + reference.information);
  const Eigen::VectorXd step =
      total.scale.cwiseProduct(total.factor.solve(total.scale.cwiseProduct(sum.gradient)).eval());
  return sum.point + step;
}

Camera withEstimated(const Camera& camera, const Intrinsics& values) {
  Intrinsics parameters = camera.parameters();
  parameters.head(values.size()) = values;
  Camera result = camera;
  result.setParameters(parameters);
  return result;
}

double pValue(double statistic, const Reference& reference) {
  const int count = reference.camera.estimatedCount();
  const Scatter& scatter = reference.scatter;
  const ScatterVariance variance =
      reference.cautious ? scatter.cautiousVariance() : scatter.variance();
  // The statistic is in sigmas times the Birge ratio.
  return variance.exceedance(squared(scatter.birgeRatio()) * statistic, count);
}

}  // namespace camera_self_calibration
