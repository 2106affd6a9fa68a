#include "camera_self_calibration/estimation/marginal.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "camera_self_calibration/estimation/linear_segment.h"
#include "camera_self_calibration/estimation/parallel.h"

namespace camera_self_calibration {

double Marginal::residualScale() const {
  const int freedom = 2 * observations - variables;
  return freedom > 0 ? std::sqrt(2.0 * cost / freedom) : 1.0;
}

Marginal marginalize(const Problem& problem, double huber, int threads) {
  const int blocks = static_cast<int>(problem.blocks.size());
  const int count = problem.intrinsicsCount();
  std::vector<LinearSegment> linear(blocks);
  parallelFor(threads, blocks, [&](int i) {
    linear[i].linearize(problem.blocks[i], *problem.camera, count, huber);
    linear[i].eliminate(0.0);
  });
  Marginal marginal;
  marginal.information.setZero(count, count);
  marginal.variables = count;
  for (int i = 0; i < blocks; ++i) {
    marginal.information += linear[i].reducedHessian();
    marginal.cost += linear[i].cost();
    marginal.observations += static_cast<int>(problem.blocks[i].segment->observations.size());
    marginal.variables += linear[i].poseColumns() + linear[i].landmarkRows();
  }
  return marginal;
}

namespace {

Intrinsics unitDiagonalScale(const IntrinsicsMatrix& information) {
  Intrinsics scale = information.diagonal();
  for (double& s : scale) s = s > 0.0 ? 1.0 / std::sqrt(s) : 0.0;
  return scale;
}

}  // namespace

Intrinsics scaledEigenvalues(const IntrinsicsMatrix& information) {
  const Intrinsics scale = unitDiagonalScale(information);
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  if (!scaled.allFinite()) return Intrinsics::Zero(information.rows());
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

std::optional<IntrinsicsMatrix> covarianceFromInformation(const IntrinsicsMatrix& information,
                                                          double rank_tolerance) {
  const Intrinsics scale = unitDiagonalScale(information);
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  if (information.rows() == 0 || !scaled.allFinite()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  if (!(eigen.eigenvalues()(0) > rank_tolerance)) return std::nullopt;
  const Eigen::MatrixXd inverse = eigen.eigenvectors() *
                                  eigen.eigenvalues().cwiseInverse().asDiagonal() *
                                  eigen.eigenvectors().transpose();
  return IntrinsicsMatrix(scale.asDiagonal() * inverse * scale.asDiagonal());
}

}  // namespace camera_self_calibration
