#include "estimation/dense_problem.h"

#include <cmath>

#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {

DenseProblem::DenseProblem(const SegmentBlock& block, const Camera& camera, int intrinsics_count)
    : block_(block), camera_(camera), intrinsics_(intrinsics_count) {
  poses_ = 6 * (static_cast<int>(block.segment->keyframes.size()) - block.fixed_keyframes);
  for (std::size_t l = 0; l < block.segment->landmarks.size(); ++l) {
    landmarks_ += block.segment->landmarks[l].anchored ? 1 : 3;
    landmarks_ -= static_cast<int>(l) == block.fixed_landmark;
  }
}

void DenseProblem::move(const Eigen::VectorXd& step, Segment* segment, Camera* camera) const {
  int at = 0;
  for (std::size_t k = block_.fixed_keyframes; k < segment->keyframes.size(); ++k, at += 6) {
    Rigid3& pose = segment->keyframes[k].world_from_camera;
    pose.translation += step.segment<3>(at);
    pose.rotation = pose.rotation * expSo3(step.segment<3>(at + 3));
  }
  for (std::size_t l = 0; l < segment->landmarks.size(); ++l) {
    Landmark& landmark = segment->landmarks[l];
    if (static_cast<int>(l) != block_.fixed_landmark) landmark.inverse_depth += step(at++);
    if (landmark.anchored) continue;
    const Eigen::Vector3d moved =
        landmark.bearing + tangentBasis(landmark.bearing) * step.segment<2>(at);
    landmark.bearing = moved.normalized();
    at += 2;
  }
  Intrinsics parameters = camera->parameters();
  parameters.head(intrinsics_) += step.tail(intrinsics_);
  camera->setParameters(parameters);
}

Eigen::Vector2d DenseProblem::predict(const Segment& segment, const Camera& camera,
                                      const Observation& observation) const {
  const Landmark& landmark = segment.landmarks[observation.landmark];
  const Eigen::Vector3d ray =
      landmark.anchored
          ? camera.unproject(landmark.reference_pixel).value_or(Eigen::Vector3d::Constant(NAN))
          : landmark.bearing;
  const Eigen::Vector3d point =
      segment.keyframes[landmark.reference].world_from_camera * (ray / landmark.inverse_depth);
  const Eigen::Vector3d local =
      segment.keyframes[observation.keyframe].world_from_camera.inverse() * point;
  Eigen::Vector2d pixel;
  return camera.project(local, &pixel) ? pixel : Eigen::Vector2d(Eigen::Vector2d::Constant(NAN));
}

Eigen::VectorXd DenseProblem::residuals(const Eigen::VectorXd& step) const {
  Segment segment = *block_.segment;
  Camera camera = camera_;
  move(step, &segment, &camera);
  Eigen::VectorXd all(2 * segment.observations.size());
  for (std::size_t o = 0; o < segment.observations.size(); ++o) {
    const Observation& observation = segment.observations[o];
    all.segment<2>(2 * o) = (observation.pixel - predict(segment, camera, observation)) /
                            (observation.sigma * block_.sigma_scale);
  }
  return all;
}

double DenseProblem::cost(const Eigen::VectorXd& step, double huber) const {
  const Eigen::VectorXd all = residuals(step);
  double sum = 0.0;
  for (Eigen::Index o = 0; o < all.size(); o += 2) {
    const double norm = all.segment<2>(o).norm();
    sum += huber > 0.0 && norm > huber ? huber * norm - 0.5 * huber * huber : 0.5 * norm * norm;
  }
  return sum;
}

Eigen::VectorXd DenseProblem::rootWeights(double huber) const {
  const Eigen::VectorXd all = residuals(Eigen::VectorXd::Zero(variables()));
  Eigen::VectorXd roots = Eigen::VectorXd::Ones(all.size());
  for (Eigen::Index o = 0; o < all.size(); o += 2) {
    const double norm = all.segment<2>(o).norm();
    if (huber > 0.0 && norm > huber) roots.segment<2>(o).setConstant(std::sqrt(huber / norm));
  }
  return roots;
}

Eigen::VectorXd DenseProblem::stepSizes() const {
  Eigen::VectorXd sizes = Eigen::VectorXd::Constant(variables(), 1e-3);
  for (int i = 0; i < intrinsics_; ++i) {
    sizes(poses_ + landmarks_ + i) = i < 4 ? 1.0 : 1e-3;
  }
  return sizes;
}

Eigen::MatrixXd DenseProblem::jacobian() const {
  const Eigen::VectorXd sizes = stepSizes();
  Eigen::MatrixXd result(2 * block_.segment->observations.size(), variables());
  for (int i = 0; i < variables(); ++i) {
    const auto difference = [&](double h) -> Eigen::VectorXd {
      const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(variables(), i);
      return -(residuals(step) - residuals(-step)) / (2.0 * h);
    };
    // Richardson: errors of the order h^4.
    const double h = 0.1 * sizes(i);
    result.col(i) = (4.0 * difference(0.5 * h) - difference(h)) / 3.0;
  }
  return result;
}

}  // namespace camera_self_calibration
