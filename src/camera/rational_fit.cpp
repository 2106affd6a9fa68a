#include "camera_self_calibration/camera/rational_fit.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "camera_self_calibration/camera/pixel_grid.h"

namespace camera_self_calibration {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Where on the axis-symmetric curve a pixel of the source lies.
struct RadialSample {
  double q = 0.0;      // squared radius in front of the lens, (x^2 + y^2) / z^2
  double scale = 0.0;  // distorted over undistorted radius
};

std::vector<RadialSample> samplesOf(const RationalPolynomial& start,
                                    const std::vector<PixelRay>& grid) {
  std::vector<RadialSample> samples;
  for (const PixelRay& point : grid) {
    if (point.ray.z() <= 0.0) continue;
    const double q = (point.ray.head<2>() / point.ray.z()).squaredNorm();
    const Eigen::Vector2d distorted((point.pixel.x() - start.cx) / start.fx,
                                    (point.pixel.y() - start.cy) / start.fy);
    if (q > 0.0) samples.push_back({q, distorted.norm() / std::sqrt(q)});
  }
  return samples;
}

double denominator(const Vector6d& k, double t) { return 1.0 + t * (k[3] + t * (k[4] + t * k[5])); }

// N(q) / D(q) = scale, linear in the coefficients when multiplied by D; the weight undoes that
// with the last round's D and turns the error into pixels. q is counted in units of `unit`.
Vector6d fitCoefficients(const std::vector<RadialSample>& samples, double unit) {
  const auto rows = static_cast<Eigen::Index>(samples.size());
  Vector6d k = Vector6d::Zero();
  constexpr int kRounds = 10;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::MatrixXd a(rows, 6);
    Eigen::VectorXd b(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const RadialSample& sample = samples[static_cast<std::size_t>(i)];
      const double t = sample.q / unit;
      const double weight = std::sqrt(sample.q) / std::max(1e-3, std::abs(denominator(k, t)));
      const Eigen::RowVector3d powers(t, t * t, t * t * t);
      a.row(i) << weight * powers, -weight * sample.scale * powers;
      b[i] = weight * (sample.scale - 1.0);
    }
    k = a.colPivHouseholderQr().solve(b);
  }
  return k;
}

RationalPolynomial withoutDenominator(const Camera& source) {
  const Intrinsics& p = source.parameters();
  RationalPolynomial camera{p[0], p[1], p[2], p[3], {}};
  std::copy(p.data() + 4, p.data() + p.size(), camera.coefficients.begin());
  return camera;
}

}  // namespace

std::optional<RationalFit> fitRationalPolynomial(const Camera& source) {
  const std::vector<PixelRay> grid = pixelGrid(source);
  Eigen::Vector2d centre;
  Matrix23d j;
  if (grid.size() < 2 * kMaxIntrinsics || !source.project(Eigen::Vector3d::UnitZ(), &centre, &j)) {
    return std::nullopt;
  }
  if (source.model() == CameraModel::kPinhole || source.model() == CameraModel::kRadtan) {
    return RationalFit{withoutDenominator(source), {}};
  }
  RationalPolynomial camera{j(0, 0), j(1, 1), centre.x(), centre.y(), {}};
  const std::vector<RadialSample> samples = samplesOf(camera, grid);
  if (samples.size() < 2 * kMaxIntrinsics) return std::nullopt;
  double unit = 0.0;
  for (const RadialSample& sample : samples) unit = std::max(unit, sample.q);
  Vector6d k = fitCoefficients(samples, unit);
  for (int i = 0; i < 6; ++i) k[i] /= std::pow(unit, i % 3 + 1);
  camera.coefficients = {k[0], k[1], 0.0, 0.0, k[2], k[3], k[4], k[5]};
  return RationalFit{camera, directDistance(camera, grid)};
}

}  // namespace camera_self_calibration
