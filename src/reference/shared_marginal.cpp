#include "camera_self_calibration/reference/shared_marginal.h"

#include <ceres/crs_matrix.h>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "camera_self_calibration/base/decompositions.h"

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

// J^T J, factored. The variables are scaled to a unit diagonal, so that units do not matter.
class ScaledFactor {
 public:
  explicit ScaledFactor(const SparseRows& jacobian) {
    Eigen::SparseMatrix<double> h = jacobian.transpose() * jacobian;
    scale_.resize(h.rows());
    for (Eigen::Index i = 0; i < h.rows(); ++i) {
      const double diagonal = h.coeff(i, i);
      scale_(i) = diagonal > 0.0 ? 1.0 / std::sqrt(diagonal) : 0.0;
    }
    h = scale_.asDiagonal() * h * scale_.asDiagonal();
    for (Eigen::Index i = 0; i < h.rows(); ++i) h.coeffRef(i, i) = 1.0 + kDamping;
    factor_.compute(h);
  }

  bool usable() const {
    return factor_.info() == Eigen::Success && factor_.vectorD().minCoeff() > 0.0;
  }
  const Eigen::VectorXd& scale() const { return scale_; }
  // Of the scaled system.
  Eigen::MatrixXd solveScaled(const Eigen::MatrixXd& right) const { return factor_.solve(right); }
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const {
    return scale_.asDiagonal() * solveScaled(scale_.asDiagonal() * right);
  }

 private:
  Eigen::VectorXd scale_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

// Rows of H^-1 that belong to the last n variables, one a column; empty where these are not
// observed.
Eigen::MatrixXd lastInverseColumns(const SparseRows& jacobian, int n) {
  const ScaledFactor factor(jacobian);
  // What nothing depends on has no scale: its scaled variance says nothing.
  if (!factor.usable() || !(factor.scale().tail(n).minCoeff() > 0.0)) return {};
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(jacobian.cols(), n);
  right.bottomRows(n).setIdentity();
  const Eigen::MatrixXd solved = factor.solveScaled(right);
  if (!(solved.bottomRows(n).diagonal().maxCoeff() < kUnobserved)) return {};
  return factor.scale().asDiagonal() * solved * factor.scale().tail(n).asDiagonal();
}

// sum psi psi^T over clusters, psi the sum of their rows of `jacobian` times the residuals.
Eigen::MatrixXd squaresOfClusters(const Eigen::VectorXd& residuals, const Eigen::MatrixXd& jacobian,
                                  const std::vector<int>& clusters) {
  const Eigen::MatrixXd rows = residuals.asDiagonal() * jacobian;
  const int count = clusters.empty() ? 0 : 1 + *std::max_element(clusters.begin(), clusters.end());
  Eigen::MatrixXd psi = Eigen::MatrixXd::Zero(jacobian.cols(), count);
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    psi.col(clusters[i]) += (rows.row(row) + rows.row(row + 1)).transpose();
  }
  return psi * psi.transpose();
}

// What makes up for the degrees of freedom that variables take.
double factorOfFreedom(int observations, int variables) {
  const int freedom = 2 * observations - variables;
  return freedom > 0 ? 2.0 * observations / freedom : 1.0;
}

}  // namespace

double SharedMarginal::freedomFactor() const { return factorOfFreedom(observations, variables); }

double SharedInformation::freedomFactor() const { return factorOfFreedom(observations, variables); }

// The correlation along clusters is an average over all directions that are seen: of a single one
// few clusters tell it badly.
double SharedInformation::varianceFactor() const {
  const LeastNormSolution solution = leastNormSolution(information, scatter);
  const double along = solution.rank > 0 ? solution.x.trace() / solution.rank : 1.0;
  return std::max(1.0, freedomFactor() * std::max(along, cost / std::max(1, observations)));
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
  marginal.influence = squaresOfClusters(linear.residuals, linear.jacobian * columns, clusters);
  marginal.cost = linear.cost;
  marginal.observations = static_cast<int>(linear.residuals.size() / 2);
  marginal.variables = static_cast<int>(linear.jacobian.cols());
  return marginal;
}

std::optional<SharedInformation> sharedInformation(ceres::Problem* problem,
                                                   const std::vector<double*>& blocks, int count,
                                                   const std::vector<int>& clusters, int threads) {
  Linearization linear;
  if (!linearize(problem, blocks, threads, &linear)) return std::nullopt;
  const Eigen::Index others = linear.jacobian.cols() - count;
  const SparseRows jacobian_others = linear.jacobian.leftCols(others);
  const Eigen::MatrixXd jacobian_shared = linear.jacobian.rightCols(count);
  const ScaledFactor factor(jacobian_others);
  if (!factor.usable()) return std::nullopt;
  // With all others eliminated: `J_s - J_o (J_o^T J_o)^-1 J_o^T J_s`.
  const Eigen::MatrixXd reduced =
      jacobian_shared -
      jacobian_others * factor.solve(jacobian_others.transpose() * jacobian_shared);
  SharedInformation result;
  result.information = reduced.transpose() * reduced;
  result.gradient = -(reduced.transpose() * linear.residuals);
  result.scatter = squaresOfClusters(linear.residuals, reduced, clusters);
  result.cost = linear.cost;
  result.observations = static_cast<int>(linear.residuals.size() / 2);
  result.variables = static_cast<int>(linear.jacobian.cols());
  return result;
}

}  // namespace camera_self_calibration
