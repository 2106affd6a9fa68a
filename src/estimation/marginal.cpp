#include "camera_self_calibration/estimation/marginal.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "camera_self_calibration/base/decompositions.h"
#include "camera_self_calibration/base/parallel.h"
#include "camera_self_calibration/estimation/inverse_depth_noise.h"
#include "camera_self_calibration/estimation/linear_segments.h"

namespace camera_self_calibration {

double Marginal::residualScale() const {
  const int freedom = 2 * observations - variables;
  return freedom > 0 ? std::sqrt(2.0 * cost / freedom) : 1.0;
}

Marginal marginalize(const Problem& problem, double huber, int threads, InverseDepthNoise noise) {
  const int blocks = static_cast<int>(problem.blocks.size());
  const int count = problem.intrinsicsCount();
  LinearSegments linear(problem.blocks.size());
  std::vector<ReducedInformation> reduced(problem.blocks.size());
  parallelFor(threads, blocks, [&](int i) {
    linear[i].linearize(problem.blocks[i], *problem.camera, count, huber, true);
    // Eq. (4): the inverse's block of the intrinsics is the inverse of what elimination leaves
    linear[i].eliminate(0.0);
    reduced[i] = noise == InverseDepthNoise::kCounts
                     ? reducedInformation(linear[i])
                     : discountedInformation(problem.blocks[i], linear[i]);
  });
  Marginal marginal;
  marginal.information.setZero(count, count);
  marginal.whole_information.setZero(count, count);
  marginal.track_scores.setZero(count, count);
  marginal.gradient.setZero(count);
  marginal.variables = count;
  for (int i = 0; i < blocks; ++i) {
    marginal.information += reduced[i].information;
    marginal.shares.push_back({linear[i].reducedHessian(), linear[i].reducedGradient()});
    marginal.whole_information += marginal.shares.back().information;
    marginal.track_scores += reduced[i].track_scores;
    marginal.gradient += reduced[i].gradient;
    marginal.cost += linear[i].cost();
    marginal.observations += static_cast<int>(problem.blocks[i].segment->observations.size());
    marginal.variables += linear[i].variables();
  }
  const int freedom = 2 * marginal.observations - marginal.variables;
  if (freedom > 0) marginal.track_scores *= 2.0 * marginal.observations / freedom;
  return marginal;
}

double Marginal::designEffect() const {
  const auto covariance = covarianceFromInformation(information);
  if (!covariance) return 1.0;
  const double effect =
      (*covariance * track_scores).trace() / static_cast<double>(information.rows());
  return std::isfinite(effect) ? effect : 1.0;
}

double Marginal::sigmaScale() const {
  const double scale = residualScale();
  return std::sqrt(std::max({1.0, scale * scale, designEffect()}));
}

double Marginal::remainingStep() const {
  const auto covariance = covarianceFromInformation(information);
  if (!covariance) return std::numeric_limits<double>::infinity();
  return std::sqrt(std::max(0.0, gradient.dot(*covariance * gradient)));
}

std::optional<IntrinsicsMatrix> Marginal::robustCovariance() const {
  const auto covariance = covarianceFromInformation(information);
  if (!covariance) return std::nullopt;
  const Eigen::MatrixXd root = Eigen::LLT<Eigen::MatrixXd>(*covariance).matrixL();
  // With I^-1 = L L^T: I^-1 M I^-1 = L (L^T M L) L^T, and the middle is the identity for
  // independent residuals.
  return IntrinsicsMatrix(widened(root, root.transpose() * track_scores * root));
}

Eigen::MatrixXd widened(const Eigen::MatrixXd& root, const Eigen::MatrixXd& factor) {
  const SymmetricEigen eigen = symmetricEigen(factor);
  const Eigen::MatrixXd axes = root * eigen.vectors;
  return axes * eigen.values.cwiseMax(1.0).asDiagonal() * axes.transpose();
}

namespace {

Intrinsics unitDiagonalScale(const IntrinsicsMatrix& information) {
  return information.diagonal().unaryExpr(&inverseRoot);
}

}  // namespace

Intrinsics scaledEigenvalues(const IntrinsicsMatrix& information) {
  const Intrinsics scale = unitDiagonalScale(information);
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  if (!scaled.allFinite()) return Intrinsics::Zero(information.rows());
  return symmetricEigenvalues(scaled);
}

std::optional<IntrinsicsMatrix> covarianceFromInformation(const IntrinsicsMatrix& information,
                                                          double rank_tolerance) {
  const Intrinsics scale = unitDiagonalScale(information);
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  if (information.rows() == 0 || !scaled.allFinite()) return std::nullopt;
  const SymmetricEigen eigen = symmetricEigen(scaled);
  if (!(eigen.values(0) > rank_tolerance)) return std::nullopt;
  // Eq. (5), which inverts the reduced system to the intrinsics' block of eq. (4)
  const Eigen::MatrixXd inverse =
      eigen.vectors * eigen.values.cwiseInverse().asDiagonal() * eigen.vectors.transpose();
  return IntrinsicsMatrix(scale.asDiagonal() * inverse * scale.asDiagonal());
}

}  // namespace camera_self_calibration
