#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>

namespace camera_self_calibration {

/// 1 / sqrt(value), or 0 for what is not positive: scales a matrix to a unit diagonal.
inline double inverseRoot(double value) { return value > 0.0 ? 1.0 / std::sqrt(value) : 0.0; }

/// The pseudo-inverse of a symmetric positive semi-definite matrix as `F F^T`: from its Cholesky
/// factorisation where that is sound, else from the eigenvectors above a tolerance, after scaling
/// to a unit diagonal. Keeps its memory from one matrix to the next.
class PseudoInverse {
 public:
  /// `matrix`: the lower triangle is used. Eigenvalues of the scaled matrix below `rank_tolerance`
  /// times the largest count as zero.
  void compute(const Eigen::Ref<const Eigen::MatrixXd>& matrix, double rank_tolerance);

  /// Columns of F.
  Eigen::Index rank() const { return regular_ ? scale_.size() : factor_.cols(); }

  /// `F^T x`, rank() rows.
  void whiten(const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::MatrixXd* result) const;
  /// `F x`, for x of rank() rows.
  void unwhiten(const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::MatrixXd* result) const;
  /// `F F^T x`.
  Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& x) const;

 private:
  void computeSingular(double rank_tolerance);

  bool regular_ = true;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd scaled_;  // lower triangle
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
  Eigen::MatrixXd factor_;  // where not regular
};

}  // namespace camera_self_calibration
