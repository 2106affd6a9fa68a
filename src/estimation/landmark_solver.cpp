#include "camera_self_calibration/estimation/landmark_solver.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <cstddef>
#include <vector>

#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/estimation/transfer.h"
#include "problem_state.h"

namespace camera_self_calibration {
namespace {

constexpr double kShorter = 0.25;  // a step that did not lower the cost

// One landmark's cost, and the normal equations of its inverse depth and two directions of its
// bearing; zeros where that is held.
struct Equations {
  double cost = 0.0;
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();

  // Gauss-Newton; zero in directions that have no information.
  Eigen::Vector3d step() const { return hessian.ldlt().solve(gradient); }
};

class LandmarkSolver {
 public:
  LandmarkSolver(const SegmentBlock& block, const Camera& camera,
                 const LandmarkSolverOptions& options)
      : segment_(*block.segment),
        sigma_scale_(block.sigma_scale),
        camera_(camera),
        options_(options),
        transfers_(segment_) {}

  // The landmark whose observations these are.
  void solve(std::size_t begin, std::size_t end);

 private:
  Equations equations(const Landmark& landmark);

  Segment& segment_;
  const double sigma_scale_;
  const Camera& camera_;
  const LandmarkSolverOptions options_;
  Transfers transfers_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  Eigen::Vector3d anchored_ray_;
};

Equations LandmarkSolver::equations(const Landmark& landmark) {
  Equations sum;
  const Eigen::Vector3d& ray = landmark.anchored ? anchored_ray_ : landmark.bearing;
  const Matrix32d basis = landmark.anchored ? Matrix32d::Zero() : tangentBasis(landmark.bearing);
  for (std::size_t o = begin_; o < end_; ++o) {
    const Observation& observation = segment_.observations[o];
    const double sigma = observation.sigma * sigma_scale_;
    const Transfer& transfer = transfers_.between(landmark.reference, observation.keyframe);
    const Camera& seen_with = segment_.cameraOf(observation.keyframe, camera_);
    Eigen::Vector2d pixel;
    Matrix23d d_point;
    if (!seen_with.project(transfer(ray, landmark.inverse_depth), &pixel, &d_point)) {
      sum.cost += unpredictableCost(sigma, options_.huber);
      continue;
    }
    const Eigen::Vector2d residual = (observation.pixel - pixel) / sigma;
    const HuberLoss loss(residual.squaredNorm(), options_.huber);
    sum.cost += loss.cost;
    d_point *= loss.root_weight / sigma;
    Eigen::Matrix<double, 2, 3> jacobian;
    jacobian << d_point * transfer.translation, d_point * transfer.rotation * basis;
    sum.hessian += jacobian.transpose() * jacobian;
    sum.gradient += jacobian.transpose() * (loss.root_weight * residual);
  }
  return sum;
}

void LandmarkSolver::solve(std::size_t begin, std::size_t end) {
  begin_ = begin;
  end_ = end;
  Landmark& landmark = segment_.landmarks[segment_.observations[begin].landmark];
  const Camera& seen_with = segment_.cameraOf(landmark.reference, camera_);
  if (!landmarkRay(seen_with, landmark, &anchored_ray_, nullptr)) return;
  Equations present = equations(landmark);
  Eigen::Vector3d step = present.step();
  for (int i = 0; i < options_.max_evaluations; ++i) {
    const double sigmas = std::sqrt(step.dot(present.hessian * step));
    if (!std::isfinite(sigmas) || sigmas < options_.precision) return;
    Landmark trial = landmark;
    trial.inverse_depth += step(0);
    if (!trial.anchored) turnBearing(step.tail<2>(), &trial);
    const Equations there = equations(trial);
    if (there.cost < present.cost) {
      landmark = trial;
      present = there;
      step = present.step();
    } else {
      step *= kShorter;
    }
  }
}

}  // namespace

void solveLandmarks(const SegmentBlock& block, const Camera& camera,
                    const LandmarkSolverOptions& options) {
  const std::vector<Observation>& observations = block.segment->observations;
  LandmarkSolver solver(block, camera, options);
  for (std::size_t begin = 0, end = 0; begin < observations.size(); begin = end) {
    while (end < observations.size() && observations[end].landmark == observations[begin].landmark)
      ++end;
    solver.solve(begin, end);
  }
}

}  // namespace camera_self_calibration
