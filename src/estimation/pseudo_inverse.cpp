#include "camera_self_calibration/estimation/pseudo_inverse.h"

#include <limits>

namespace camera_self_calibration {

void PseudoInverse::compute(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                            double rank_tolerance) {
  const Eigen::Index n = matrix.rows();
  regular_ = true;
  scale_ = matrix.diagonal().unaryExpr(&inverseRoot);
  if (n == 0) return;
  scaled_.setZero(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    scaled_.col(j).tail(n - j) =
        scale_(j) * scale_.tail(n - j).cwiseProduct(matrix.col(j).tail(n - j));
  }
  cholesky_.compute(scaled_);
  if (!scaled_.allFinite()) {
    scale_.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  // Squared pivots bound the eigenvalues from above; a margin keeps nearly singular systems out.
  regular_ = cholesky_.info() == Eigen::Success &&
             cholesky_.matrixLLT().diagonal().minCoeff() > 1e2 * std::sqrt(rank_tolerance);
  if (!regular_) computeSingular(rank_tolerance);
}

// With P A P^T = [T; B] [T; B]^T, T lower triangular, the columns of P^T [-T^-T B^T; 1] span the
// null space, and P^T [T^-T; 0] without its part in there is F.
void PseudoInverse::computeSingular(double rank_tolerance) {
  const Eigen::Index n = scaled_.rows();
  pivoted_.compute(scaled_, rank_tolerance * static_cast<double>(n));
  const Eigen::Index rank = pivoted_.rank();
  null_space_.setIdentity(n, n - rank);
  if (rank == 0 || rank == n) return;
  Eigen::MatrixXd top = -pivoted_.bottom().transpose();
  pivoted_.top().transpose().triangularView<Eigen::Upper>().solveInPlace(top);
  Eigen::MatrixXd square = Eigen::MatrixXd::Identity(n - rank, n - rank);
  square.selfadjointView<Eigen::Lower>().rankUpdate(top.transpose());
  const Eigen::LLT<Eigen::MatrixXd> norm(square);
  const Eigen::MatrixXd bottom =
      norm.matrixU().solve(Eigen::MatrixXd::Identity(n - rank, n - rank));
  const Eigen::MatrixXd orthonormal = top * bottom;
  for (Eigen::Index i = 0; i < n; ++i) {
    null_space_.row(pivoted_.order()(i)) = i < rank ? orthonormal.row(i) : bottom.row(i - rank);
  }
}

void PseudoInverse::removeNullSpace(Eigen::MatrixXd* x) const {
  const Eigen::MatrixXd part = null_space_.transpose() * *x;
  x->noalias() -= null_space_ * part;
}

void PseudoInverse::whiten(const Eigen::Ref<const Eigen::MatrixXd>& x,
                           Eigen::MatrixXd* result) const {
  result->noalias() = scale_.asDiagonal() * x;
  if (scale_.size() == 0) return;
  if (regular_) {
    cholesky_.matrixL().solveInPlace(*result);
    return;
  }
  Eigen::MatrixXd scaled = *result;
  removeNullSpace(&scaled);
  result->resize(rank(), x.cols());
  for (Eigen::Index i = 0; i < rank(); ++i) result->row(i) = scaled.row(pivoted_.order()(i));
  if (rank() > 0) pivoted_.top().triangularView<Eigen::Lower>().solveInPlace(*result);
}

void PseudoInverse::unwhiten(const Eigen::Ref<const Eigen::MatrixXd>& x,
                             Eigen::MatrixXd* result) const {
  *result = x;
  if (scale_.size() == 0) return;
  if (regular_) {
    cholesky_.matrixU().solveInPlace(*result);
  } else {
    Eigen::MatrixXd solved = x;
    if (rank() > 0) {
      pivoted_.top().transpose().triangularView<Eigen::Upper>().solveInPlace(solved);
    }
    result->setZero(scale_.size(), x.cols());
    for (Eigen::Index i = 0; i < rank(); ++i) result->row(pivoted_.order()(i)) = solved.row(i);
    removeNullSpace(result);
  }
  *result = scale_.asDiagonal() * *result;
}

Eigen::MatrixXd PseudoInverse::solve(const Eigen::Ref<const Eigen::MatrixXd>& x) const {
  Eigen::MatrixXd whitened, result;
  whiten(x, &whitened);
  unwhiten(whitened, &result);
  return result;
}

}  // namespace camera_self_calibration
