#include <ceres/crs_matrix.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "batch_problem.h"
#include "camera_self_calibration/reference/batch.h"
#include "input_check.h"

namespace camera_self_calibration {
namespace {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

struct Linearization {
  SparseRows jacobian;  // the intrinsics' columns last
  Eigen::VectorXd residuals;
  double cost = 0.0;
};

bool linearize(BatchProblem* batch, int threads, Linearization* result) {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = batch->freeBlocks();
  options.num_threads = std::max(1, threads);
  std::vector<double> residuals;
  ceres::CRSMatrix crs;
  if (!batch->problem()->Evaluate(options, &result->cost, &residuals, nullptr, &crs)) return false;
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
// A scaled variance from which an intrinsic parameter counts as not observed.
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

// sum psi psi^T over the landmarks of all segments.
Eigen::MatrixXd influenceSquares(const std::vector<BatchSegment>& segments,
                                 const Linearization& linear, const Eigen::MatrixXd& columns) {
  const Eigen::MatrixXd rows = linear.residuals.asDiagonal() * (linear.jacobian * columns);
  const Eigen::Index n = columns.cols();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  Eigen::Index row = 0;
  for (const BatchSegment& batch : segments) {
    Eigen::MatrixXd psi =
        Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(batch.segment->landmarks.size()));
    for (const Observation& seen : batch.segment->observations) {
      psi.col(seen.landmark) += (rows.row(row) + rows.row(row + 1)).transpose();
      row += 2;
    }
    sum += psi * psi.transpose();
  }
  return sum;
}

}  // namespace

std::optional<Marginal> batchMarginal(const std::vector<BatchSegment>& segments,
                                      const Camera& camera, const BatchOptions& options) {
  if (!inputProblem(segments, camera).empty()) return std::nullopt;
  BatchOptions with_intrinsics = options;
  with_intrinsics.estimate_intrinsics = true;
  BatchProblem batch(segments, camera, with_intrinsics);
  Linearization linear;
  if (!batch.usesIntrinsics() || !linearize(&batch, options.threads, &linear)) return std::nullopt;
  const int n = camera.estimatedCount();
  const Eigen::MatrixXd columns = lastInverseColumns(linear.jacobian, n);
  if (columns.size() == 0) return std::nullopt;

  Marginal marginal;
  marginal.information = columns.bottomRows(n).inverse();  // Eq. (4)
  marginal.track_scores =
      marginal.information * influenceSquares(segments, linear, columns) * marginal.information;
  marginal.cost = linear.cost;
  marginal.observations = static_cast<int>(linear.residuals.size() / 2);
  marginal.variables = static_cast<int>(linear.jacobian.cols());
  const int freedom = 2 * marginal.observations - marginal.variables;
  if (freedom > 0) marginal.track_scores *= 2.0 * marginal.observations / freedom;
  return marginal;
}

}  // namespace camera_self_calibration
