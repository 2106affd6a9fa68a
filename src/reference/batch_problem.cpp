#include "batch_problem.h"

#include <ceres/loss_function.h>

#include <Eigen/Core>
#include <numeric>

#include "camera_self_calibration/reference/constraint.h"
#include "camera_self_calibration/reference/residuals.h"

namespace camera_self_calibration {

BatchProblem::BatchProblem(const std::vector<BatchSegment>& segments, const Camera& camera,
                           const BatchOptions& options)
    : camera_(camera), intrinsics_(camera.parameters()), options_(options) {
  for (const BatchSegment& segment : segments) {
    addResiduals(segment);
    constrain(segment);
  }
  constrainIntrinsics();
}

std::vector<double*> BatchProblem::freeBlocks() {
  std::vector<double*> blocks;
  problem_.GetParameterBlocks(&blocks);
  std::vector<double*> free;
  for (double* block : blocks) {
    if (block != intrinsics_.data() && !problem_.IsParameterBlockConstant(block)) {
      free.push_back(block);
    }
  }
  free.push_back(intrinsics_.data());
  return free;
}

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

}  // namespace camera_self_calibration
