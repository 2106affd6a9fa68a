#pragma once

#include <Eigen/Core>

namespace camera_self_calibration {

/// Cholesky factorisation `P A P^T = L L^T` of a symmetric positive semi-definite matrix, with the
/// largest remaining diagonal entry as the next pivot: the columns end where the rank does. Takes a
/// fraction of the time of an eigen-decomposition. Keeps its memory from one matrix to the next.
class PivotedCholesky {
 public:
  /// `matrix`: the lower triangle is used. What is left of the matrix once no remaining diagonal
  /// entry is above `smallest_pivot` counts as zero.
  void compute(const Eigen::Ref<const Eigen::MatrixXd>& matrix, double smallest_pivot);

  Eigen::Index rank() const { return rank_; }
  /// Row of A that row i of L stands for: the first rank() make a regular matrix.
  const Eigen::VectorXi& order() const { return order_; }
  /// L: its first rank() rows, lower triangular, and the others.
  auto top() const { return factor_.topLeftCorner(rank_, rank_); }
  auto bottom() const { return factor_.bottomLeftCorner(factor_.rows() - rank_, rank_); }

 private:
  void exchange(Eigen::Index k, Eigen::Index other);

  Eigen::Index rank_ = 0;
  Eigen::VectorXi order_;
  Eigen::MatrixXd factor_;  // lower triangle: finished columns of L, then A's own
  Eigen::VectorXd rest_;    // of the diagonal, without the finished columns
};

}  // namespace camera_self_calibration
