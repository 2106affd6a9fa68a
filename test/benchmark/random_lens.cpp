#include "benchmark/random_lens.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

/// The distortion of a lens and the radius in units of fx at which its image ends, left and right.
struct Distortion {
  Eigen::VectorXd parameters;
  double edge_radius = 0.0;
};

Distortion randomFov(double half_angle, Random& random) {
  const double w = random.uniform(0.5, 1.1);
  const double edge = std::atan(2.0 * std::tan(half_angle) * std::tan(w / 2.0)) / w;
  return {Eigen::VectorXd::Constant(1, w), edge};
}

Distortion randomRadtan(double half_angle, Random& random) {
  const double r2 = std::pow(std::tan(half_angle), 2);
  // Barrel distortion that stays monotonic up to the edge of the image.
  const double k1 = -0.3 * random.uniform(0.2, 1.0) * std::min(1.0, 1.0 / r2);
  const double k2 = 0.25 * k1 * k1 * random.uniform();
  Distortion result;
  result.parameters.resize(4);
  result.parameters << k1, k2, random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3);
  result.edge_radius = std::sqrt(r2) * (1.0 + k1 * r2 + k2 * r2 * r2);
  return result;
}

Distortion randomEquidistant(double half_angle, Random& random) {
  Distortion result;
  result.parameters.resize(4);
  result.parameters << random.uniform(-0.05, 0.05), random.uniform(-0.02, 0.02),
      random.uniform(-0.005, 0.005), random.uniform(-0.001, 0.001);
  double power = half_angle;
  result.edge_radius = half_angle;
  for (int i = 0; i < 4; ++i) {
    power *= half_angle * half_angle;
    result.edge_radius += result.parameters(i) * power;
  }
  return result;
}

double randomFieldOfView(CameraModel model, Random& random) {
  switch (model) {
    case CameraModel::kPinhole:
      return random.uniform(40.0, 100.0);
    case CameraModel::kFov:
      return random.uniform(60.0, 140.0);
    case CameraModel::kRadtan:
      return random.uniform(50.0, 110.0);
    case CameraModel::kEquidistant:
      return random.uniform(80.0, 170.0);
  }
  return 90.0;
}

Distortion randomDistortion(CameraModel model, double half_angle, Random& random) {
  switch (model) {
    case CameraModel::kPinhole:
      return {Eigen::VectorXd(), std::tan(half_angle)};
    case CameraModel::kFov:
      return randomFov(half_angle, random);
    case CameraModel::kRadtan:
      return randomRadtan(half_angle, random);
    case CameraModel::kEquidistant:
      return randomEquidistant(half_angle, random);
  }
  return {};
}

}  // namespace

RandomLens randomLens(CameraModel model, int width, int height, std::uint64_t seed) {
  Random random(mixSeed(seed, static_cast<std::uint64_t>(model)));
  const double field_of_view = randomFieldOfView(model, random);
  const Distortion distortion = randomDistortion(model, field_of_view * M_PI / 360.0, random);
  const double f = 0.5 * width / distortion.edge_radius;
  const double aspect = random.uniform(0.98, 1.02);
  const double shift = 0.03 * width;
  const double cx = 0.5 * (width - 1) + random.uniform(-shift, shift);
  const double cy = 0.5 * (height - 1) + random.uniform(-shift, shift);

  Eigen::VectorXd parameters(4 + distortion.parameters.size());
  parameters << f, f * aspect, cx, cy, distortion.parameters;
  return {Camera(model, width, height, parameters), field_of_view};
}

CameraModel modelOf(std::uint64_t seed) {
  constexpr std::array<CameraModel, 4> kModels = {CameraModel::kFov, CameraModel::kRadtan,
                                                  CameraModel::kEquidistant, CameraModel::kPinhole};
  return kModels[seed % kModels.size()];
}

}  // namespace camera_self_calibration
