#include "camera_self_calibration/reference/batch.h"

#include <ceres/covariance.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Core>
#include <algorithm>
#include <numeric>

#include "camera_self_calibration/reference/residuals.h"
#include "constraint.h"
#include "input_check.h"

namespace camera_self_calibration {
namespace {

// The Ceres problem over the memory of the segments and a copy of the intrinsics.
class BatchProblem {
 public:
  BatchProblem(const std::vector<BatchSegment>& segments, const Camera& camera,
               const BatchOptions& options)
      : camera_(camera), intrinsics_(camera.parameters()), options_(options) {
    for (const BatchSegment& segment : segments) {
      addResiduals(segment);
      constrain(segment);
    }
    constrainIntrinsics();
  }

  ceres::Problem* problem() { return &problem_; }
  const Intrinsics& intrinsics() const { return intrinsics_; }
  bool usesIntrinsics() const { return problem_.HasParameterBlock(intrinsics_.data()); }

 private:
  void addResiduals(const BatchSegment& batch);
  void add(ceres::CostFunction* cost, const std::vector<double*>& blocks);
  void constrain(const BatchSegment& batch);
  void constrainIntrinsics();
  void fix(double* block) {
    if (problem_.HasParameterBlock(block)) problem_.SetParameterBlockConstant(block);
  }

  Camera camera_;
  Intrinsics intrinsics_;
  BatchOptions options_;
  ceres::Problem problem_;
};

void BatchProblem::addResiduals(const BatchSegment& batch) {
  Segment& segment = *batch.segment;
  for (const Observation& seen : segment.observations) {
    Landmark& landmark = segment.landmarks[seen.landmark];
    const double sigma = seen.sigma * batch.sigma_scale;
    if (seen.keyframe == landmark.reference) {
      add(new FirstObservationResidual(camera_, seen.pixel, sigma),
          {landmark.bearing.data(), intrinsics_.data()});
      continue;
    }
    Rigid3& i = segment.keyframes[seen.keyframe].world_from_camera;
    Rigid3& r = segment.keyframes[landmark.reference].world_from_camera;
    std::vector<double*> blocks{i.rotation.coeffs().data(), i.translation.data(),
                                r.rotation.coeffs().data(), r.translation.data(),
                                &landmark.inverse_depth};
    if (!landmark.anchored) blocks.push_back(landmark.bearing.data());
    blocks.push_back(intrinsics_.data());
    if (landmark.anchored) {
      add(new AnchoredResidual(camera_, landmark.reference_pixel, seen.pixel, sigma), blocks);
    } else {
      add(new InheritedResidual(camera_, seen.pixel, sigma), blocks);
    }
  }
}

void BatchProblem::add(ceres::CostFunction* cost, const std::vector<double*>& blocks) {
  ceres::LossFunction* loss = options_.huber > 0.0 ? new ceres::HuberLoss(options_.huber) : nullptr;
  problem_.AddResidualBlock(cost, loss, blocks);
}

void BatchProblem::constrain(const BatchSegment& batch) {
  Segment& segment = *batch.segment;
  for (int k = 0; k < static_cast<int>(segment.keyframes.size()); ++k) {
    Rigid3& pose = segment.keyframes[k].world_from_camera;
    if (!problem_.HasParameterBlock(pose.rotation.coeffs().data())) continue;
    keepUnitQuaternion(&problem_, pose.rotation.coeffs().data());
    if (k >= batch.fixed_keyframes) continue;
    fix(pose.rotation.coeffs().data());
    fix(pose.translation.data());
  }
  for (Landmark& landmark : segment.landmarks) {
    if (problem_.HasParameterBlock(landmark.bearing.data())) {
      keepUnitVector(&problem_, landmark.bearing.data());
    }
  }
  if (batch.fixed_landmark >= 0) fix(&segment.landmarks[batch.fixed_landmark].inverse_depth);
}

void BatchProblem::constrainIntrinsics() {
  if (!usesIntrinsics()) return;
  if (!options_.estimate_intrinsics) return fix(intrinsics_.data());
  std::vector<int> held(camera_.parameterCount() - camera_.estimatedCount());
  std::iota(held.begin(), held.end(), camera_.estimatedCount());
  if (!held.empty()) {
    keepEntries(&problem_, intrinsics_.data(), camera_.parameterCount(), held);
  }
}

ceres::Solver::Options solverOptions(const BatchOptions& options) {
  ceres::Solver::Options ceres_options;
  ceres_options.max_num_iterations = options.max_iterations;
  ceres_options.num_threads = std::max(1, options.threads);
  // Landmarks are eliminated first; Ceres finds the blocks that can be.
  ceres_options.linear_solver_type = options.small ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  // An oracle goes down to rounding.
  ceres_options.function_tolerance = 1e-15;
  ceres_options.gradient_tolerance = 1e-14;
  ceres_options.parameter_tolerance = 1e-13;
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
