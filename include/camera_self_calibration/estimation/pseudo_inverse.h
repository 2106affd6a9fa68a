#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>

#include "camera_self_calibration/estimation/pivoted_cholesky.h"

namespace camera_self_calibration {

/// 1 / sqrt(value), or 0 for what is not positive: scales a matrix to a unit diagonal.
inline double inverseRoot(double value) { return value > 0.0 ? 1.0 / std::sqrt(value) : 0.0; }

/// The pseudo-inverse of a symmetric positive semi-definite matrix as `F F^T`, after scaling to a
/// unit diagonal: from its Cholesky factorisation where that is sound, else from one that reveals
/// the rank. Keeps its memory from one matrix to the next.
class PseudoInverse {
 public:
  /// `matrix`: the lower triangle is used. What is below `rank_tolerance` times the trace of the
  /// scaled matrix, which bounds the largest eigenvalue, counts as zero. Of a matrix that is not
  /// finite nothing that follows is.
  void compute(const Eigen::Ref<const Eigen::MatrixXd>& matrix, double rank_tolerance);

  /// Columns of F.
  Eigen::Index rank() const { return regular_ ? scale_.size() : pivoted_.rank(); }
  /// `F^T x`, rank() rows.
  void whiten(const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::MatrixXd* result) const;
  /// `F x`, for x of rank() rows.
  void unwhiten(const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::MatrixXd* result) const;
  /// `F F^T x`.
  Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& x) const;

 private:
  void computeSingular(double rank_tolerance);
  void removeNullSpace(Eigen::MatrixXd* x) const;

  bool regular_ = true;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd scaled_;  // lower triangle
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
  // Where not regular.
  PivotedCholesky pivoted_;
  Eigen::MatrixXd null_space_;  // orthonormal columns
};

}  // namespace camera_self_calibration
