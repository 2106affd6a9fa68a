#include "camera_self_calibration/estimation/pseudo_inverse.h"

#include <Eigen/Eigenvalues>

namespace camera_self_calibration {

void PseudoInverse::compute(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                            double rank_tolerance) {
  const Eigen::Index n = matrix.rows();
  regular_ = true;
  scale_ = matrix.diagonal().unaryExpr(&inverseRoot);
  if (n == 0) return;
  scaled_.resize(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    scaled_.col(j).tail(n - j) =
        scale_(j) * scale_.tail(n - j).cwiseProduct(matrix.col(j).tail(n - j));
  }
  cholesky_.compute(scaled_);
  // Squared pivots bound the eigenvalues from above; a margin keeps nearly singular systems out.
  regular_ = cholesky_.info() == Eigen::Success &&
             cholesky_.matrixLLT().diagonal().minCoeff() > 1e2 * std::sqrt(rank_tolerance);
  if (!regular_) computeSingular(rank_tolerance);
}

void PseudoInverse::computeSingular(double rank_tolerance) {
  const Eigen::Index n = scaled_.rows();
  // Uses the lower triangle alone.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled_);
  const double threshold = rank_tolerance * eigen.eigenvalues()(n - 1);
  Eigen::Index first = 0;
  while (first < n && eigen.eigenvalues()(first) <= threshold) ++first;
  factor_ = scale_.asDiagonal() * eigen.eigenvectors().rightCols(n - first) *
            eigen.eigenvalues().tail(n - first).cwiseSqrt().cwiseInverse().asDiagonal();
}

void PseudoInverse::whiten(const Eigen::Ref<const Eigen::MatrixXd>& x,
                           Eigen::MatrixXd* result) const {
  if (!regular_) {
    result->noalias() = factor_.transpose() * x;
    return;
  }
  result->noalias() = scale_.asDiagonal() * x;
  if (scale_.size() > 0) cholesky_.matrixL().solveInPlace(*result);
}

void PseudoInverse::unwhiten(const Eigen::Ref<const Eigen::MatrixXd>& x,
                             Eigen::MatrixXd* result) const {
  if (!regular_) {
    result->noalias() = factor_ * x;
    return;
  }
  *result = x;
  if (scale_.size() > 0) cholesky_.matrixU().solveInPlace(*result);
  *result = scale_.asDiagonal() * *result;
}

Eigen::MatrixXd PseudoInverse::solve(const Eigen::Ref<const Eigen::MatrixXd>& x) const {
  Eigen::MatrixXd whitened, result;
  whiten(x, &whitened);
  unwhiten(whitened, &result);
  return result;
}

}  // namespace camera_self_calibration
