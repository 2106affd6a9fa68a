#include "camera_self_calibration/estimation/pivoted_cholesky.h"

#include <cmath>
#include <utility>

namespace camera_self_calibration {

// Eigen's LDLT takes its pivots from the matrix as given, not from what is left of it, and reveals
// no rank.
void PivotedCholesky::compute(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                              double smallest_pivot) {
  const Eigen::Index n = matrix.rows();
  factor_ = matrix;
  rest_ = matrix.diagonal();
  order_.setLinSpaced(n, 0, static_cast<int>(n) - 1);
  for (rank_ = 0; rank_ < n; ++rank_) {
    const Eigen::Index k = rank_;
    const Eigen::Index below = n - k - 1;
    Eigen::Index largest = 0;
    const double pivot = rest_.tail(n - k).maxCoeff(&largest);
    if (!(pivot > smallest_pivot)) return;
    if (largest > 0) exchange(k, k + largest);
    auto column = factor_.col(k).tail(below);
    column.noalias() -= factor_.block(k + 1, 0, below, k) * factor_.row(k).head(k).transpose();
    factor_(k, k) = std::sqrt(pivot);
    column /= factor_(k, k);
    rest_.tail(below) -= column.cwiseAbs2();
  }
}

// Of rows and columns in the lower triangle. The diagonal is in rest_.
void PivotedCholesky::exchange(Eigen::Index k, Eigen::Index other) {
  const Eigen::Index between = other - k - 1;
  const Eigen::Index below = factor_.rows() - other - 1;
  std::swap(order_(k), order_(other));
  std::swap(rest_(k), rest_(other));
  factor_.row(k).head(k).swap(factor_.row(other).head(k));
  factor_.col(k)
      .segment(k + 1, between)
      .swap(factor_.row(other).segment(k + 1, between).transpose());
  factor_.col(k).tail(below).swap(factor_.col(other).tail(below));
}

}  // namespace camera_self_calibration
