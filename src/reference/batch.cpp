#include "camera_self_calibration/reference/batch.h"

#include <ceres/covariance.h>
#include <ceres/solver.h>

#include <algorithm>

#include "batch_problem.h"
#include "input_check.h"

namespace camera_self_calibration {
namespace {

ceres::Solver::Options solverOptions(const BatchOptions& options) {
  ceres::Solver::Options ceres_options;
  ceres_options.max_num_iterations = options.max_iterations;
  ceres_options.num_threads = std::max(1, options.threads);
  // Landmarks are eliminated first; Ceres finds the blocks that can be.
  ceres_options.linear_solver_type = options.small ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  ceres_options.function_tolerance = options.tolerance;
  ceres_options.gradient_tolerance = 10.0 * options.tolerance;
  ceres_options.parameter_tolerance = 100.0 * options.tolerance;
  ceres_options.logging_type = ceres::SILENT;
  return ceres_options;
}

}  // namespace

BatchSummary solveBatch(const std::vector<BatchSegment>& segments, Camera* camera,
                        const BatchOptions& options) {
  BatchSummary summary;
  summary.message = inputProblem(segments, *camera);
  if (!summary.message.empty()) return summary;
  BatchProblem batch(segments, *camera, options);
  if (!batch.usesIntrinsics()) {
    summary.message = "there are no observations";
    return summary;
  }
  ceres::Solver::Summary ceres_summary;
  ceres::Solve(solverOptions(options), batch.problem(), &ceres_summary);
  if (ceres_summary.IsSolutionUsable()) camera->setParameters(batch.intrinsics());
  summary.converged = ceres_summary.termination_type == ceres::CONVERGENCE;
  summary.initial_cost = ceres_summary.initial_cost;
  summary.final_cost = ceres_summary.final_cost;
  summary.iterations = ceres_summary.num_successful_steps + ceres_summary.num_unsuccessful_steps;
  summary.message = ceres_summary.message;
  return summary;
}

std::optional<IntrinsicsMatrix> batchCovariance(const std::vector<BatchSegment>& segments,
                                                const Camera& camera, const BatchOptions& options) {
  if (!inputProblem(segments, camera).empty()) return std::nullopt;
  BatchOptions with_intrinsics = options;
  with_intrinsics.estimate_intrinsics = true;
  BatchProblem batch(segments, camera, with_intrinsics);
  if (!batch.usesIntrinsics()) return std::nullopt;
  ceres::Covariance::Options ceres_options;
  ceres_options.num_threads = std::max(1, options.threads);
  ceres::Covariance covariance(ceres_options);
  const double* block = batch.intrinsics().data();
  const std::vector<std::pair<const double*, const double*>> wanted{{block, block}};
  if (!covariance.Compute(wanted, batch.problem())) return std::nullopt;
  const int n = camera.estimatedCount();
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> result(n, n);
  if (!covariance.GetCovarianceBlockInTangentSpace(block, block, result.data())) {
    return std::nullopt;
  }
  return IntrinsicsMatrix(result);
}

}  // namespace camera_self_calibration
