#include "camera_self_calibration/rig/rig_solver.h"

#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "camera_self_calibration/reference/shared_marginal.h"
#include "rig_problem.h"

namespace camera_self_calibration {
namespace {

// A covariance that is in no direction smaller than `least`.
Eigen::MatrixXd atLeast(const Eigen::MatrixXd& least, const Eigen::MatrixXd& covariance) {
  // With least = L L^T, covariance = L M L^T, and M counts where it is above the identity.
  const Eigen::LLT<Eigen::MatrixXd> factor(least);
  const Eigen::MatrixXd half = factor.matrixL().solve(covariance);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      factor.matrixL().solve(half.transpose()));
  const Eigen::MatrixXd axes = factor.matrixL() * eigen.eigenvectors();
  return axes * eigen.eigenvalues().cwiseMax(1.0).asDiagonal() * axes.transpose();
}

// Tangents of Ceres' quaternions are half rotation vectors, applied from the left.
void toRotationVectors(const RigLayout& layout, Eigen::MatrixXd* covariance) {
  for (const int at : layout.pose_at) {
    if (at < 0) continue;
    covariance->middleRows(at, 3) *= 2.0;
    covariance->middleCols(at, 3) *= 2.0;
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
  toRotationVectors(layout, &covariance);
  if (!covariance.allFinite()) return std::nullopt;
  return covariance;
}

}  // namespace camera_self_calibration
