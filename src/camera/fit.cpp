#include "camera_self_calibration/camera/fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "camera_self_calibration/camera/fit_without_k3.h"
#include "camera_self_calibration/camera/pixel_grid.h"
#include "camera_self_calibration/camera/rational_fit.h"

namespace camera_self_calibration {
namespace {

// Shares of a cost: where it is plain which of several starts leads to the best fit, and where the
// parameters are within 3e-5 of what the fit leaves over.
constexpr double kToldApart = 1e-3;
constexpr double kSettled = 1e-9;

// Sum of squares [px^2] over the grid; a ray that the camera cannot project counts as an error of
// the image's size, so that the fit does not improve by refusing rays.
double cost(const Camera& camera, const std::vector<PixelRay>& grid) {
  const double refused =
      static_cast<double>(camera.width()) * camera.width() + camera.height() * camera.height();
  double sum = 0.0;
  for (const PixelRay& point : grid) {
    Eigen::Vector2d pixel;
    sum += camera.project(point.ray, &pixel) ? (pixel - point.pixel).squaredNorm() : refused;
  }
  return sum;
}

struct NormalEquations {
  IntrinsicsMatrix h;
  Intrinsics g;
};

// One product of the whole grid, since many small ones take twice as long.
NormalEquations linearise(const Camera& camera, const std::vector<PixelRay>& grid) {
  const auto rows = 2 * static_cast<Eigen::Index>(grid.size());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows, camera.parameterCount());
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(rows);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    Eigen::Vector2d pixel;
    PixelIntrinsicsJacobian j;
    if (!camera.project(grid[i].ray, &pixel, nullptr, &j)) continue;
    const auto row = 2 * static_cast<Eigen::Index>(i);
    jacobian.middleRows<2>(row) = j;
    residual.segment<2>(row) = pixel - grid[i].pixel;
  }
  return {jacobian.transpose() * jacobian, jacobian.transpose() * residual};
}

// Levenberg-Marquardt over all parameters, until a step gains less than this share of the cost;
// returns the final cost.
double refine(const std::vector<PixelRay>& grid, double least_gain, Camera* camera) {
  double current = cost(*camera, grid);
  double damping = 1e-4;
  NormalEquations normal = linearise(*camera, grid);
  for (int i = 0; i < 100 && damping < 1e12; ++i) {
    IntrinsicsMatrix h = normal.h;
    h.diagonal() += damping * normal.h.diagonal() +
                    Intrinsics::Constant(h.rows(), std::numeric_limits<double>::min());
    Camera candidate = *camera;
    candidate.setParameters(camera->parameters() - h.ldlt().solve(normal.g));
    const double next = candidate.valid() ? cost(candidate, grid) : current;
    if (next < current) {
      const bool done = current - next < least_gain * current;
      *camera = candidate;
      current = next;
      damping = std::max(0.1 * damping, 1e-15);
      if (done) break;
      normal = linearise(*camera, grid);
    } else {
      damping *= 10.0;
    }
  }
  return current;
}

// Cameras with this fx fy cx cy at the axis; several for fov, whose cost is not convex in w.
std::vector<Camera> starts(const Eigen::Vector4d& axis, int width, int height, CameraModel target) {
  Intrinsics p = Intrinsics::Zero(Camera::parameterCount(target));
  p.head<4>() = axis;
  std::vector<Camera> cameras;
  if (target == CameraModel::kFov) {
    for (const double w : {0.1, 0.5, 0.9, 1.3, 1.8}) {
      p.head<2>() = axis.head<2>() * w / (2.0 * std::tan(0.5 * w));
      p[4] = w;
      cameras.emplace_back(target, width, height, p);
    }
  } else {
    cameras.emplace_back(target, width, height, p);
    cameras.back().setEstimateK3(true);  // radtan: plumb_bob has five coefficients
  }
  return cameras;
}

std::optional<CameraFit> bestFit(const std::vector<PixelRay>& grid, std::vector<Camera> from) {
  if (grid.size() < 2 * kMaxIntrinsics) return std::nullopt;
  std::optional<Camera> best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (Camera& camera : from) {
    const double c = refine(grid, kToldApart, &camera);
    if (c < best_cost) {
      best = camera;
      best_cost = c;
    }
  }
  if (!best) return std::nullopt;
  refine(grid, kSettled, &*best);
  return CameraFit{*best, directDistance(*best, grid)};
}

}  // namespace

std::optional<CameraFit> fitCamera(const Camera& source, CameraModel target) {
  std::vector<Camera> from = {source};
  if (source.model() != target) {
    Eigen::Vector2d pixel;
    Matrix23d j;
    if (!source.project(Eigen::Vector3d::UnitZ(), &pixel, &j)) return std::nullopt;
    // For a fov source this is the closed form f_e = s f, s = 2 tan(w/2) / w.
    from =
        starts({j(0, 0), j(1, 1), pixel.x(), pixel.y()}, source.width(), source.height(), target);
  }
  std::optional<CameraFit> fit = bestFit(pixelGrid(source), std::move(from));
  if (fit) fit->camera.setEstimateK3(source.estimatedCount() == kMaxIntrinsics);
  return fit;
}

std::optional<CameraFit> fitCamera(const RationalPolynomial& source, int width, int height,
                                   CameraModel target) {
  const auto unproject = [&](const Eigen::Vector2d& pixel) { return source.unproject(pixel); };
  const Eigen::Vector4d axis(source.fx, source.fy, source.cx, source.cy);
  std::optional<CameraFit> fit =
      bestFit(pixelGrid(width, height, unproject), starts(axis, width, height, target));
  if (fit) fit->camera.setEstimateK3(false);
  return fit;
}

std::optional<CameraFit> fitWithoutK3(const Camera& radtan) {
  if (radtan.model() != CameraModel::kRadtan) return std::nullopt;
  const Camera start(CameraModel::kRadtan, radtan.width(), radtan.height(),
                     radtan.parameters().head(Camera::parameterCount(CameraModel::kRadtan)));
  return bestFit(pixelGrid(radtan), {start});
}

Camera withLeastFovW(const Camera& camera) {
  constexpr double kLeastW = 0.2;
  if (camera.model() != CameraModel::kFov || camera.parameters()[4] >= kLeastW) return camera;
  const auto axisScale = [](double w) { return 2.0 * std::tan(0.5 * w) / w; };
  Intrinsics p = camera.parameters();
  p.head<2>() *= axisScale(p[4]) / axisScale(kLeastW);
  p[4] = kLeastW;
  Camera start = camera;
  start.setParameters(p);
  return start;
}

}  // namespace camera_self_calibration
