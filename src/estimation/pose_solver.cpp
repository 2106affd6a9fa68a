#include "camera_self_calibration/estimation/pose_solver.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

using Matrix66d = Eigen::Matrix<double, 6, 6>;

// Whitened residual of one view; false where it cannot be predicted.
bool viewResidual(const Camera& camera, const PoseMatrices& pose, const PointView& view,
                  Eigen::Vector2d* residual, Matrix26d* jacobian) {
  // Rotation is applied to a ray that is already in the world.
  PoseMatrices reference{Rigid3(Eigen::Quaterniond::Identity(), view.origin)};
  Eigen::Vector2d pixel;
  PredictionJacobians jacobians;
  if (!predictPixel(camera, reference, pose, view.direction, view.inverse_depth, false, &pixel,
                    jacobian != nullptr ? &jacobians : nullptr)) {
    return false;
  }
  *residual = (view.pixel - pixel) / view.sigma;
  if (jacobian != nullptr) *jacobian = jacobians.observing_pose / view.sigma;
  return true;
}

double poseCost(const Camera& camera, const Rigid3& world_from_camera,
                const std::vector<PointView>& views, double huber) {
  const PoseMatrices pose(world_from_camera);
  double cost = 0.0;
  for (const PointView& view : views) {
    Eigen::Vector2d residual;
    const bool predicted = viewResidual(camera, pose, view, &residual, nullptr);
    cost += huberCost(predicted ? residual.norm() : kUnpredictableResidualPx / view.sigma, huber);
  }
  return cost;
}

void poseEquations(const Camera& camera, const Rigid3& world_from_camera,
                   const std::vector<PointView>& views, double huber, Matrix66d* hessian,
                   Vector6d* gradient) {
  const PoseMatrices pose(world_from_camera);
  hessian->setZero();
  gradient->setZero();
  for (const PointView& view : views) {
    Eigen::Vector2d residual;
    Matrix26d jacobian;
    if (!viewResidual(camera, pose, view, &residual, &jacobian)) continue;
    const double weight = huberWeight(residual.norm(), huber);
    hessian->noalias() += weight * jacobian.transpose() * jacobian;
    gradient->noalias() += weight * jacobian.transpose() * residual;
  }
}

Rigid3 moved(const Rigid3& pose, const Vector6d& step) {
  return {(pose.rotation * expSo3(step.tail<3>())).normalized(), pose.translation + step.head<3>()};
}

void countInliers(const Camera& camera, const std::vector<PointView>& views,
                  PoseEstimate* estimate) {
  const PoseMatrices pose(estimate->world_from_camera);
  // A view that cannot be predicted is no inlier, whatever the scale of the others.
  std::vector<double> norms(views.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < views.size(); ++i) {
    Eigen::Vector2d residual;
    if (viewResidual(camera, pose, views[i], &residual, nullptr)) norms[i] = residual.norm();
  }
  std::vector<double> sorted = norms;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  constexpr double kMedianNorm = 1.1774;  // of two standard normal coordinates
  estimate->residual_scale = std::max(1.0, sorted[sorted.size() / 2] / kMedianNorm);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double limit = std::max(3.5 * estimate->residual_scale, 1.0 / views[i].sigma);
    estimate->inliers += norms[i] < limit;
  }
}

}  // namespace

std::vector<PointView> earlierPointsSeenIn(int k, const Segment& segment, const Camera& camera) {
  std::vector<PointView> views;
  for (const Observation& observation : segment.observations) {
    const Landmark& landmark = segment.landmarks[observation.landmark];
    if (observation.keyframe != k || landmark.reference >= k) continue;
    Eigen::Vector3d ray;
    const Camera& seen_with = segment.cameraOf(landmark.reference, camera);
    if (!landmarkRay(seen_with, landmark, &ray, nullptr)) continue;
    const Rigid3& reference = segment.keyframes[landmark.reference].world_from_camera;
    views.push_back({{reference.rotation * ray, reference.translation, landmark.inverse_depth},
                     observation.pixel,
                     observation.sigma});
  }
  return views;
}

PoseEstimate solvePose(const Camera& camera, const std::vector<PointView>& views,
                       const Rigid3& guess, double huber, int max_iterations) {
  PoseEstimate estimate;
  estimate.world_from_camera = guess;
  if (views.size() < 3) return estimate;
  double cost = poseCost(camera, guess, views, huber);
  Matrix66d hessian;
  Vector6d gradient;
  double damping = 1e-6;
  for (int i = 0; i < max_iterations; ++i) {
    poseEquations(camera, estimate.world_from_camera, views, huber, &hessian, &gradient);
    Matrix66d damped = hessian;
    damped.diagonal() *= 1.0 + damping;
    const Vector6d step = damped.ldlt().solve(gradient);
    if (!step.allFinite()) return estimate;
    const Rigid3 trial = moved(estimate.world_from_camera, step);
    const double trial_cost = poseCost(camera, trial, views, huber);
    if (!(trial_cost < cost)) {
      damping *= 100.0;
      if (damping > 1e4) break;
      continue;
    }
    const bool done = cost - trial_cost < 1e-6 * cost;
    estimate.world_from_camera = trial;
    cost = trial_cost;
    damping = std::max(1e-9, damping * 0.1);
    if (done) break;
  }
  countInliers(camera, views, &estimate);
  if (!std::isfinite(estimate.residual_scale)) return estimate;  // most lie behind the camera
  poseEquations(camera, estimate.world_from_camera, views, huber, &hessian, &gradient);
  const Eigen::LDLT<Matrix66d> factor(hessian);
  if (factor.info() == Eigen::Success && factor.vectorD().minCoeff() > 0.0) {
    estimate.covariance =
        estimate.residual_scale * estimate.residual_scale * factor.solve(Matrix66d::Identity());
    estimate.usable = estimate.covariance.allFinite();
  }
  return estimate;
}

}  // namespace camera_self_calibration
