#include "camera_self_calibration/rig/rig_solver.h"

#include <ceres/iteration_callback.h>
#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/reference/shared_marginal.h"
#include "rig_problem.h"

namespace camera_self_calibration {
namespace {

// A covariance that is in no direction smaller than `least`.
Eigen::MatrixXd atLeast(const Eigen::MatrixXd& least, const Eigen::MatrixXd& covariance) {
  const Eigen::LLT<Eigen::MatrixXd> factor(least);
  const Eigen::MatrixXd half = factor.matrixL().solve(covariance);
  return widened(factor.matrixL(), factor.matrixL().solve(half.transpose()));
}

struct Stop : ceres::IterationCallback {
  explicit Stop(const std::function<bool()>& asked) : stop(asked) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return stop() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }
  const std::function<bool()>& stop;
};

// Tangents of Ceres' quaternions are half rotation vectors, applied from the left.
constexpr double kRotationPerTangent = 2.0;

void scaleRotations(const RigLayout& layout, double factor, Eigen::MatrixXd* square) {
  for (const int at : layout.pose_at) {
    if (at < 0) continue;
    square->middleRows(at, 3) *= factor;
    square->middleCols(at, 3) *= factor;
  }
}

}  // namespace

RigLayout::RigLayout(const Rig& rig, const RigSolveOptions& options) {
  for (int c = 0; c < rig.size(); ++c) {
    pose_at.push_back(c == 0 ? -1 : size);
    if (c > 0) size += 6;
  }
  for (int c = 0; c < rig.size(); ++c) {
    intrinsics_at.push_back(held(options, c) ? -1 : size);
    if (!held(options, c)) size += rig.cameras[c].estimatedCount();
  }
}

bool solveRig(const RigSolveOptions& options, std::vector<RigSegment>* segments, Rig* rig) {
  RigProblem problem(options, segments, rig);
  if (problem.empty()) return false;
  ceres::Solver::Options solver;
  solver.max_num_iterations = options.max_iterations;
  solver.num_threads = std::max(1, options.threads);
  solver.linear_solver_type = ceres::SPARSE_SCHUR;
  solver.function_tolerance = options.tolerance;
  solver.logging_type = ceres::SILENT;
  Stop stop(options.stop);
  if (options.stop) solver.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, problem.problem(), &summary);
  if (!summary.IsSolutionUsable()) return false;
  problem.takeOver();
  return true;
}

std::optional<Eigen::MatrixXd> rigCovariance(const RigSolveOptions& options,
                                             std::vector<RigSegment>* segments, Rig* rig) {
  RigProblem problem(options, segments, rig);
  if (problem.empty()) return std::nullopt;
  const RigLayout layout(*rig, options);
  // A camera without observations.
  if (problem.sharedSize() != layout.size) return std::nullopt;
  const auto marginal = sharedMarginal(problem.problem(), problem.freeBlocks(), layout.size,
                                       problem.clusters(), options.threads);
  if (!marginal || !marginal->covariance.allFinite()) return std::nullopt;
  const double factor = marginal->freedomFactor();
  const double scale = std::max(1.0, marginal->cost / marginal->observations * factor);
  Eigen::MatrixXd covariance = atLeast(scale * marginal->covariance, factor * marginal->influence);
  scaleRotations(layout, kRotationPerTangent, &covariance);
  if (!covariance.allFinite()) return std::nullopt;
  return covariance;
}

std::optional<RigLikelihood> rigLikelihood(const RigSolveOptions& options,
                                           std::vector<RigSegment>* segments, const Rig& rig) {
  RigLikelihood result;
  result.rig = rig;
  RigSolveOptions free = options;
  free.hold_intrinsics.clear();
  RigProblem problem(free, segments, &result.rig);
  const RigLayout layout(rig, free);
  if (problem.empty() || problem.sharedSize() != layout.size) return std::nullopt;
  const auto shared = sharedInformation(problem.problem(), problem.freeBlocks(), layout.size,
                                        problem.clusters(), options.threads);
  if (!shared || !shared->information.allFinite()) return std::nullopt;
  const double factor = shared->varianceFactor();
  if (!std::isfinite(factor)) return std::nullopt;
  result.begin_ns = segments->front().stamps_ns.front();
  result.end_ns = segments->back().stamps_ns.back();
  result.information = shared->information / factor;
  result.gradient = shared->gradient / factor;
  scaleRotations(layout, 1.0 / kRotationPerTangent, &result.information);
  for (const int at : layout.pose_at) {
    if (at >= 0) result.gradient.segment<3>(at) /= kRotationPerTangent;
  }
  return result;
}

}  // namespace camera_self_calibration
