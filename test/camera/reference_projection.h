#pragma once

#include <array>
#include <cmath>
#include <functional>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

/// The camera models written down once more, in extended precision and straight from their
/// definitions, with derivatives by differences: the oracle of the tests of Camera::project.
using Real = long double;
using Pixel = std::array<Real, 2>;

inline Pixel referenceProject(CameraModel model, const std::array<Real, 9>& p,
                              const std::array<Real, 3>& point) {
  const Real x = point[0], y = point[1], z = point[2];
  const Real r = std::hypot(x, y);
  Real u = x / z, v = y / z;
  if (model == CameraModel::kFov && r > 0) {
    const Real distorted = std::atan2(2 * r * std::tan(p[4] / 2), z) / p[4];
    u = x / r * distorted;
    v = y / r * distorted;
  } else if (model == CameraModel::kFov) {
    u = v = 0;
  } else if (model == CameraModel::kEquidistant) {
    const Real t = std::atan2(r, z);
    const Real distorted = t + p[4] * std::pow(t, 3) + p[5] * std::pow(t, 5) +
                           p[6] * std::pow(t, 7) + p[7] * std::pow(t, 9);
    u = r > 0 ? x / r * distorted : 0;
    v = r > 0 ? y / r * distorted : 0;
  } else if (model == CameraModel::kRadtan) {
    const Real a = u, b = v, r2 = a * a + b * b;
    const Real gain = 1 + p[4] * r2 + p[5] * r2 * r2 + p[8] * r2 * r2 * r2;
    u = a * gain + 2 * p[6] * a * b + p[7] * (r2 + 2 * a * a);
    v = b * gain + p[6] * (r2 + 2 * b * b) + 2 * p[7] * a * b;
  }
  return {p[0] * u + p[2], p[1] * v + p[3]};
}

/// Central difference of fourth order.
inline Eigen::Vector2d difference(const std::function<Pixel(Real)>& f, Real step) {
  const Pixel a = f(-2 * step), b = f(-step), c = f(step), d = f(2 * step);
  Eigen::Vector2d slope;
  for (int i = 0; i < 2; ++i) {
    slope[i] = static_cast<double>((a[i] - 8 * b[i] + 8 * c[i] - d[i]) / (12 * step));
  }
  return slope;
}

class ReferenceCamera {
 public:
  explicit ReferenceCamera(const Camera& camera) : model_(camera.model()) {
    for (int i = 0; i < camera.parameterCount(); ++i) parameters_[i] = camera.parameters()[i];
  }

  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    const Pixel pixel = referenceProject(model_, parameters_, {point.x(), point.y(), point.z()});
    return {static_cast<double>(pixel[0]), static_cast<double>(pixel[1])};
  }

  Eigen::Vector2d slopeInPoint(const Eigen::Vector3d& point, int axis, Real step) const {
    return difference(
        [&](Real change) {
          std::array<Real, 3> moved{point.x(), point.y(), point.z()};
          moved[axis] += change;
          return referenceProject(model_, parameters_, moved);
        },
        step);
  }

  Eigen::Vector2d slopeInParameter(const Eigen::Vector3d& point, int index, Real step) const {
    return difference(
        [&](Real change) {
          std::array<Real, 9> moved = parameters_;
          moved[index] += change;
          return referenceProject(model_, moved, {point.x(), point.y(), point.z()});
        },
        step);
  }

 private:
  CameraModel model_;
  std::array<Real, 9> parameters_{};
};

}  // namespace camera_self_calibration
