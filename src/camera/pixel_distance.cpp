#include "camera_self_calibration/camera/pixel_distance.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "camera_self_calibration/camera/pixel_difference.h"
#include "camera_self_calibration/geometry/so3.h"
#include "pixel_grid.h"

namespace camera_self_calibration {
namespace {

// [rad] A rotation that moves no pixel by more than a millionth.
constexpr double kSettled = 1e-9;

struct PointDerivatives {
  Eigen::Vector2d pixel;
  PixelIntrinsicsJacobian a;  // d pixel / d intrinsics, estimated ones
  Matrix23d b;                // d pixel / d rotation of the camera
};

std::vector<PointDerivatives> gridDerivatives(const Camera& camera, const ImageField& field) {
  std::vector<PointDerivatives> all;
  for (const PixelRay& point : pixelGrid(camera, field)) {
    Eigen::Vector2d pixel;
    Matrix23d j;
    PixelIntrinsicsJacobian d_parameters;
    if (!camera.project(point.ray, &pixel, &j, &d_parameters)) continue;
    all.push_back(
        {point.pixel, d_parameters.leftCols(camera.estimatedCount()), -j * skew(point.ray)});
  }
  return all;
}

struct RotationStep {
  int projected = 0;
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
    h += j.transpose() * j;
    g += j.transpose() * residual;
    sum += residual.squaredNorm();
    step.error.max = std::max(step.error.max, residual.norm());
    ++step.projected;
  }
  if (step.projected == 0) return step;
  step.error.rms = std::sqrt(sum / step.projected);
  step.omega = -h.ldlt().solve(g);
  return step;
}

struct BestRotation {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  PixelError error = PixelError::unknown();
};

BestRotation bestRotation(const std::vector<PixelRay>& grid, const Camera& b) {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  BestRotation best;
  for (int i = 0; i < 20; ++i) {
    const RotationStep step = rotationStep(grid, b, rotation);
    if (step.projected == 0 || !step.omega.allFinite()) break;
    if (step.error.rms < best.error.rms) best = {rotation, step.error};
    rotation = expSo3(step.omega) * rotation;
    if (step.omega.norm() < kSettled) break;
  }
  return best;
}

}  // namespace

namespace {

// Where in the image, and what the intrinsics do there that no rotation of the camera absorbs:
// A' = A - B (sum B^T B)^-1 sum B^T A.
struct CompensatedPixel {
  Eigen::Vector2d pixel;
  PixelIntrinsicsJacobian a;
};

std::vector<CompensatedPixel> compensatedDerivatives(const Camera& camera,
                                                     const ImageField& field) {
  const std::vector<PointDerivatives> grid = gridDerivatives(camera, field);
  Eigen::Matrix3d btb = Eigen::Matrix3d::Zero();
  RayIntrinsicsJacobian bta = RayIntrinsicsJacobian::Zero(3, camera.estimatedCount());
  for (const PointDerivatives& point : grid) {
    btb += point.b.transpose() * point.b;
    bta += point.b.transpose() * point.a;
  }
  const RayIntrinsicsJacobian absorbed = btb.ldlt().solve(bta);
  std::vector<CompensatedPixel> result;
  result.reserve(grid.size());
  for (const PointDerivatives& point : grid) {
    result.push_back({point.pixel, point.a - point.b * absorbed});
  }
  return result;
}

}  // namespace

std::vector<UncertainPixel> uncertaintyOverImage(const Camera& camera,
                                                 const IntrinsicsMatrix& covariance,
                                                 const ImageField& field) {
  const int n = camera.estimatedCount();
  if (covariance.rows() != n || covariance.cols() != n || !covariance.allFinite()) return {};
  std::vector<UncertainPixel> result;
  for (const CompensatedPixel& point : compensatedDerivatives(camera, field)) {
    const double trace = (point.a * covariance).cwiseProduct(point.a).sum();
    result.push_back({point.pixel, std::sqrt(std::max(0.0, trace))});
  }
  return result;
}

IntrinsicsMatrix pixelMetric(const Camera& camera, const ImageField& field) {
  const int n = camera.estimatedCount();
  IntrinsicsMatrix sum = IntrinsicsMatrix::Zero(n, n);
  const std::vector<CompensatedPixel> grid = compensatedDerivatives(camera, field);
  for (const CompensatedPixel& point : grid) sum += point.a.transpose() * point.a;
  return grid.empty() ? sum : IntrinsicsMatrix(sum / static_cast<double>(grid.size()));
}

PixelError pixelUncertainty(const Camera& camera, const IntrinsicsMatrix& covariance,
                            const ImageField& field) {
  const std::vector<UncertainPixel> grid = uncertaintyOverImage(camera, covariance, field);
  if (grid.empty()) return PixelError::unknown();
  PixelError error;
  double sum = 0.0;
  for (const UncertainPixel& point : grid) {
    sum += point.sigma * point.sigma;
    error.max = std::max(error.max, point.sigma);
  }
  error.rms = std::sqrt(sum / static_cast<double>(grid.size()));
  return error;
}

PixelError pixelDistance(const Camera& a, const Camera& b, double max_radius_px) {
  return bestRotation(pixelGrid(a, {}, max_radius_px), b).error;
}

PixelError pixelDistance(const Camera& a, const Camera& b, const ImageField& field) {
  return bestRotation(pixelGrid(a, field), b).error;
}

PixelDifference pixelDifference(const Camera& a, const Camera& b, double max_radius_px) {
  const std::vector<PixelRay> area = areaGrid(a, max_radius_px);
  const BestRotation best = bestRotation(area, b);
  PixelDifference difference;
  difference.error = best.error;
  difference.rotation_deg =
      best.rotation.angularDistance(Eigen::Quaterniond::Identity()) * 180.0 / M_PI;
  const auto compare = [&](const std::vector<PixelRay>& grid, auto* points) {
    for (const PixelRay& point : grid) {
      Eigen::Vector2d pixel;
      if (!b.project(best.rotation * point.ray, &pixel)) continue;
      points->push_back({point.pixel, pixel - point.pixel});
    }
    return static_cast<int>(grid.size() - points->size());
  };
  compare(area, &difference.samples);
  difference.refused = compare(pixelGrid(a, {}, max_radius_px), &difference.points);
  for (const PixelDifference::Point& point : difference.points) {
    difference.error.max = std::max(difference.error.max, point.offset.norm());
  }
  return difference;
}

}  // namespace camera_self_calibration
