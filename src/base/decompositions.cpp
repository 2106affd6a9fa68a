#include "camera_self_calibration/base/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace camera_self_calibration {

SymmetricEigen symmetricEigen(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::VectorXd symmetricEigenvalues(const Eigen::MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

LeastNormSolution leastNormSolution(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition(a);
  return {decomposition.solve(b), static_cast<int>(decomposition.rank())};
}

}  // namespace camera_self_calibration
