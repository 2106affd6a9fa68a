#include "camera_self_calibration/reference/shared_marginal.h"

#include <ceres/crs_matrix.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

namespace camera_self_calibration {
namespace {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

struct Linearization {
  SparseRows jacobian;
  Eigen::VectorXd residuals;
  double cost = 0.0;
};

bool linearize(ceres::Problem* problem, const std::vector<double*>& blocks, int threads,
               Linearization* result) {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = blocks;
  options.num_threads = std::max(1, threads);
  std::vector<double> residuals;
  ceres::CRSMatrix crs;
  if (!problem->Evaluate(options, &result->cost, &residuals, nullptr, &crs)) return false;
  result->residuals = Eigen::Map<const Eigen::VectorXd>(
      residuals.data(), static_cast<Eigen::Index>(residuals.size()));
  result->jacobian = Eigen::Map<const SparseRows>(
      crs.num_rows, crs.num_cols, static_cast<Eigen::Index>(crs.values.size()), crs.rows.data(),
      crs.cols.data(), crs.values.data());
  return true;
}

// What is added to the scaled diagonal, so that a depth or a pose that nothing observes (two views
// from one place) does no harm; it shows in no variable that is observed.
constexpr double kDamping = 1e-12;
// A scaled variance from which a variable counts as not observed.
constexpr double kUnobserved = 1e10;

// Rows of H^-1 that belong to the last n variables, one a column; empty where these are not
// observed. The variables are scaled to a unit diagonal, so that units do not matter.
Eigen::MatrixXd lastInverseColumns(const SparseRows& jacobian, int n) {
  Eigen::SparseMatrix<double> h = jacobian.transpose() * jacobian;
  Eigen::VectorXd scale(h.rows());
  for (Eigen::Index i = 0; i < h.rows(); ++i) {
    const double diagonal = h.coeff(i, i);
    scale(i) = diagonal > 0.0 ? 1.0 / std::sqrt(diagonal) : 0.0;
  }
  h = scale.asDiagonal() * h * scale.asDiagonal();
  for (Eigen::Index i = 0; i < h.rows(); ++i) h.coeffRef(i, i) = 1.0 + kDamping;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(h);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0.0)) return {};
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(h.rows(), n);
  right.bottomRows(n).setIdentity();
  const Eigen::MatrixXd solved = factor.solve(right);
  if (!(solved.bottomRows(n).diagonal().maxCoeff() < kUnobserved)) return {};
  return scale.asDiagonal() * solved * scale.tail(n).asDiagonal();
}

// sum psi psi^T over clusters.
Eigen::MatrixXd influenceSquares(const Linearization& linear, const Eigen::MatrixXd& columns,
                                 const std::vector<int>& clusters) {
  const Eigen::MatrixXd rows = linear.residuals.asDiagonal() * (linear.jacobian * columns);
  const int count = clusters.empty() ? 0 : 1 + *std::max_element(clusters.begin(), clusters.end());
  Eigen::MatrixXd psi = Eigen::MatrixXd::Zero(columns.cols(), count);
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    psi.col(clusters[i]) += (rows.row(row) + rows.row(row + 1)).transpose();
  }
  return psi * psi.transpose();
}

}  // namespace

double SharedMarginal::freedomFactor() const {
  const int freedom = 2 * observations - variables;
  return freedom > 0 ? 2.0 * observations / freedom : 1.0;
}

std::optional<SharedMarginal> sharedMarginal(ceres::Problem* problem,
                                             const std::vector<double*>& blocks, int count,
                                             const std::vector<int>& clusters, int threads) {
  Linearization linear;
  if (!linearize(problem, blocks, threads, &linear)) return std::nullopt;
  const Eigen::MatrixXd columns = lastInverseColumns(linear.jacobian, count);
  if (columns.size() == 0) return std::nullopt;
  SharedMarginal marginal;
  marginal.covariance = columns.bottomRows(count);
  marginal.influence = influenceSquares(linear, columns, clusters);
  marginal.cost = linear.cost;
  marginal.observations = static_cast<int>(linear.residuals.size() / 2);
  marginal.variables = static_cast<int>(linear.jacobian.cols());
  return marginal;
}

}  // namespace camera_self_calibration
