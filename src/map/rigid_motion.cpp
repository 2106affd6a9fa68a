#include "camera_self_calibration/map/rigid_motion.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

// Fewer features than this are not averaged over.
constexpr int kMinPoints = 12;
constexpr int kRounds = 4;
// Residuals larger than this many times their median norm count linearly (Huber), and not at all
// where they are so large that the feature has a motion of its own.
constexpr double kHuber = 2.0;
constexpr double kOwnMotion = 5.0;
// What a polynomial through few images of a shaken camera can miss of a feature's motion, of that
// motion: only what is far beyond is another one.
constexpr double kTruncation = 2.0;
// Of the diagonal: directions that nothing tells, such as the translation before a far scene, stay
// small.
constexpr double kRidge = 1e-9;
constexpr double kStep = 1e-3;  // [s] Of the numeric second derivative.

using Matrix26d = Eigen::Matrix<double, 2, 6>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

struct Equation {
  Matrix26d design;
  Eigen::Vector2d measured;
  double weight;
  int images;  // that the motion was measured in
};

// Of the point for a camera that moves: x' = -rho v - w x x.
Eigen::Vector3d pointVelocity(const MovingPoint& moving, const Vector6d& twist) {
  return -moving.inverse_depth * twist.head<3>() - twist.tail<3>().cross(moving.point);
}

// d pixel / dt = J x'
std::optional<Matrix26d> designOf(const MovingPoint& moving, const Camera& camera) {
  Eigen::Vector2d pixel;
  Matrix23d d_point;
  if (!camera.project(moving.point, &pixel, &d_point)) return std::nullopt;
  Matrix26d design;
  design.leftCols<3>() = -moving.inverse_depth * d_point;
  design.rightCols<3>() = d_point * skew(moving.point);
  return design;
}

// The acceleration in the image that a steady twist causes: of P(x(t)) with x'' = -w x x'.
std::optional<Eigen::Vector2d> steadyAcceleration(const MovingPoint& moving, const Vector6d& twist,
                                                  const Camera& camera) {
  const Eigen::Vector3d first = pointVelocity(moving, twist);
  const Eigen::Vector3d second = -twist.tail<3>().cross(first);
  const Eigen::Vector3d bent = moving.point + 0.5 * kStep * kStep * second;
  Eigen::Vector2d before, now, after;
  if (!camera.project(bent - kStep * first, &before) || !camera.project(moving.point, &now) ||
      !camera.project(bent + kStep * first, &after)) {
    return std::nullopt;
  }
  return Eigen::Vector2d((before - 2.0 * now + after) / (kStep * kStep));
}

double shareOf(double residual, double typical) {
  if (!(typical > 0.0) || residual <= kHuber * typical) return 1.0;
  return residual > kOwnMotion * typical ? 0.0 : kHuber * typical / residual;
}

// Those of the features that were measured in most images, if they are enough for some of them to
// have a motion of their own: where there are no images from before or after, the motion is several
// per cent off, and alike for all.
void keepBestMeasured(std::vector<Equation>* equations) {
  std::stable_sort(equations->begin(), equations->end(),
                   [](const Equation& a, const Equation& b) { return a.images > b.images; });
  std::size_t count = 2 * static_cast<std::size_t>(kMinPoints);
  const auto differs = [&](std::size_t i) {
    return (*equations)[i].images != (*equations)[i - 1].images;
  };
  while (count < equations->size() && !differs(count)) ++count;
  if (count < equations->size()) equations->resize(count);
}

struct RobustFit {
  Vector6d solution = Vector6d::Zero();
  double typical = 0.0;  // weighted residual, the median
};

std::optional<RobustFit> robustFit(std::vector<Equation> equations) {
  if (static_cast<int>(equations.size()) < kMinPoints) return std::nullopt;
  keepBestMeasured(&equations);
  RobustFit fit;
  std::vector<double> residuals(equations.size(), 0.0);
  for (int round = 0; round < kRounds; ++round) {
    Matrix6d normal = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();
    for (std::size_t i = 0; i < equations.size(); ++i) {
      const Equation& equation = equations[i];
      const double weight = equation.weight * shareOf(residuals[i], fit.typical);
      normal.noalias() += weight * equation.design.transpose() * equation.design;
      right.noalias() += weight * equation.design.transpose() * equation.measured;
    }
    normal.diagonal() *= 1.0 + kRidge;
    fit.solution = normal.ldlt().solve(right);
    if (!fit.solution.allFinite()) return std::nullopt;
    for (std::size_t i = 0; i < equations.size(); ++i) {
      const Equation& equation = equations[i];
      residuals[i] =
          std::sqrt(equation.weight) * (equation.measured - equation.design * fit.solution).norm();
    }
    fit.typical = median(residuals, 0.0);
  }
  return fit;
}

}  // namespace

std::optional<CameraMotion> fitCameraMotion(const std::vector<MovingPoint>& points,
                                            const Camera& camera) {
  std::vector<Equation> velocities;
  for (const MovingPoint& moving : points) {
    const std::optional<Matrix26d> design = designOf(moving, camera);
    if (!design || moving.measured.velocity.isZero()) continue;
    velocities.push_back(
        {*design, moving.measured.velocity, moving.weight, moving.measured.images});
  }
  const std::optional<RobustFit> velocity = robustFit(velocities);
  if (!velocity) return std::nullopt;
  std::vector<Equation> accelerations;
  for (const MovingPoint& moving : points) {
    const std::optional<Matrix26d> design = designOf(moving, camera);
    const auto steady = steadyAcceleration(moving, velocity->solution, camera);
    if (!design || !steady || moving.measured.acceleration.isZero()) continue;
    accelerations.push_back(
        {*design, moving.measured.acceleration - *steady, moving.weight, moving.measured.images});
  }
  const RobustFit acceleration = robustFit(accelerations).value_or(RobustFit());
  return CameraMotion{velocity->solution, acceleration.solution, velocity->typical};
}

std::optional<ImageMotion> imageMotion(const MovingPoint& point, const CameraMotion& motion,
                                       const Camera& camera) {
  const std::optional<Matrix26d> design = designOf(point, camera);
  const auto steady = steadyAcceleration(point, motion.velocity, camera);
  if (!design || !steady) return std::nullopt;
  return ImageMotion{*design * motion.velocity, *design * motion.acceleration + *steady};
}

bool movesWithScene(const MovingPoint& point, const ImageMotion& scene, double typical_residual) {
  const Eigen::Vector2d& measured = point.measured.velocity;
  if (measured.isZero()) return true;  // seen once: nothing is known
  return (measured - scene.velocity).norm() <=
         kOwnMotion * typical_residual / std::sqrt(point.weight) + kTruncation * measured.norm();
}

}  // namespace camera_self_calibration
