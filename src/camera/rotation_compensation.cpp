#include "camera_self_calibration/camera/rotation_compensation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

// [rad] A rotation that moves no pixel by more than a millionth.
constexpr double kSettled = 1e-9;

struct PointDerivatives {
  Eigen::Vector2d pixel;
  PixelIntrinsicsJacobian a;  // d pixel / d intrinsics, estimated ones
  Matrix23d b;                // d pixel / d rotation of the camera
  double weight;
};

std::vector<PointDerivatives> derivatives(const Camera& camera, const std::vector<PixelRay>& grid) {
  std::vector<PointDerivatives> all;
  all.reserve(grid.size());
  for (const PixelRay& point : grid) {
    Eigen::Vector2d pixel;
    Matrix23d j;
    PixelIntrinsicsJacobian d_parameters;
    if (!camera.project(point.ray, &pixel, &j, &d_parameters)) continue;
    all.push_back({point.pixel, d_parameters.leftCols(camera.estimatedCount()),
                   -j * skew(point.ray), point.weight});
  }
  return all;
}

struct RotationStep {
  double projected = 0.0;                           // weight of the points that are
  PixelError error;                                 // before the step
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();  // Gauss-Newton
};

RotationStep rotationStep(const std::vector<PixelRay>& grid, const Camera& b,
                          const Eigen::Quaterniond& rotation) {
  RotationStep step;
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double sum = 0.0;
  for (const PixelRay& point : grid) {
    const Eigen::Vector3d ray = rotation * point.ray;
    Eigen::Vector2d pixel;
    Matrix23d d_ray;
    if (!b.project(ray, &pixel, &d_ray)) continue;
    const Eigen::Vector2d residual = pixel - point.pixel;
    const Matrix23d j = -d_ray * skew(ray);
    h += point.weight * j.transpose() * j;
    g += point.weight * j.transpose() * residual;
    sum += point.weight * residual.squaredNorm();
    step.error.max = std::max(step.error.max, residual.norm());
    step.projected += point.weight;
  }
  if (!(step.projected > 0.0)) return step;
  step.error.rms = std::sqrt(sum / step.projected);
  step.omega = -h.ldlt().solve(g);
  return step;
}

}  // namespace

BestRotation bestRotation(const std::vector<PixelRay>& grid, const Camera& b) {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  BestRotation best;
  for (int i = 0; i < 20; ++i) {
    const RotationStep step = rotationStep(grid, b, rotation);
    if (!(step.projected > 0.0) || !step.omega.allFinite()) break;
    if (step.error.rms < best.error.rms) best = {rotation, step.error};
    rotation = expSo3(step.omega) * rotation;
    if (step.omega.norm() < kSettled) break;
  }
  return best;
}

CompensatedGrid compensatedGrid(const Camera& camera, const std::vector<PixelRay>& grid) {
  const std::vector<PointDerivatives> all = derivatives(camera, grid);
  Eigen::Matrix3d btb = Eigen::Matrix3d::Zero();
  RayIntrinsicsJacobian bta = RayIntrinsicsJacobian::Zero(3, camera.estimatedCount());
  CompensatedGrid result;
  for (const PointDerivatives& point : all) {
    btb += point.weight * point.b.transpose() * point.b;
    bta += point.weight * point.b.transpose() * point.a;
    result.weight += point.weight;
  }
  result.absorbed = btb.ldlt().solve(bta);
  result.points.reserve(all.size());
  for (const PointDerivatives& point : all) {
    result.points.push_back({point.pixel, point.a - point.b * result.absorbed, point.weight});
  }
  return result;
}

IntrinsicsMatrix CompensatedGrid::metric() const {
  const Eigen::Index n = absorbed.cols();
  IntrinsicsMatrix sum = IntrinsicsMatrix::Zero(n, n);
  for (const CompensatedPixel& point : points) {
    sum += point.weight * point.a.transpose() * point.a;
  }
  return weight > 0.0 ? IntrinsicsMatrix(sum / weight) : sum;
}

}  // namespace camera_self_calibration
