#pragma once

#include <Eigen/Core>

namespace camera_self_calibration {

// Decompositions of small dense matrices, compiled once: each place that makes its own from Eigen's
// templates compiles ten seconds longer, with sanitizers half a minute.

/// A symmetric matrix as `vectors * values.asDiagonal() * vectors^T`.
struct SymmetricEigen {
  Eigen::VectorXd values;   ///< Ascending.
  Eigen::MatrixXd vectors;  ///< Orthonormal columns.
};

/// Of `matrix` the lower triangle is used. Nothing of a matrix that is not finite is.
SymmetricEigen symmetricEigen(const Eigen::MatrixXd& matrix);

/// The eigenvalues alone, which are found sooner.
Eigen::VectorXd symmetricEigenvalues(const Eigen::MatrixXd& matrix);

/// Of all X that make `A X - B` least, the shortest, and the rank of A.
struct LeastNormSolution {
  Eigen::MatrixXd x;
  int rank = 0;
};

LeastNormSolution leastNormSolution(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace camera_self_calibration
