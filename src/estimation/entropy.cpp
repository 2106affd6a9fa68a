#include "camera_self_calibration/estimation/entropy.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <limits>

namespace camera_self_calibration {
namespace {

// Per unit of image width for fx, fy, cx, cy; then the distortion's own units.
struct NormalizationTable {
  CameraModel model;
  std::array<double, kMaxIntrinsics> sigma;
};

constexpr double kFocal = 1e-4;
constexpr double kCentre = 1e-4;
constexpr NormalizationTable kTables[] = {
    {CameraModel::kPinhole, {kFocal, kFocal, kCentre, kCentre}},
    {CameraModel::kFov, {kFocal, kFocal, kCentre, kCentre, 2e-4}},
    {CameraModel::kRadtan, {kFocal, kFocal, kCentre, kCentre, 3e-4, 3e-4, 5e-5, 5e-5, 3e-4}},
    {CameraModel::kEquidistant, {kFocal, kFocal, kCentre, kCentre, 3e-4, 5e-4, 5e-4, 2e-4}},
};

}  // namespace

Intrinsics normalizationSigmas(const Camera& camera) {
  for (const NormalizationTable& table : kTables) {
    if (table.model != camera.model()) continue;
    Intrinsics sigmas(camera.estimatedCount());
    for (int i = 0; i < sigmas.size(); ++i) {
      sigmas(i) = table.sigma[i] * (i < 4 ? camera.width() : 1.0);
    }
    return sigmas;
  }
  return Intrinsics::Ones(camera.estimatedCount());
}

double entropy(const Camera& camera, const IntrinsicsMatrix& covariance) {
  const Intrinsics inverse = normalizationSigmas(camera).cwiseInverse();
  const Eigen::MatrixXd normalized = inverse.asDiagonal() * covariance * inverse.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> cholesky(normalized);
  if (!normalized.allFinite() || cholesky.info() != Eigen::Success) {
    return std::numeric_limits<double>::infinity();
  }
  const double half_log_determinant = cholesky.matrixLLT().diagonal().array().log().sum();
  constexpr double kHalfLog2PiE = 1.4189385332046727;  // ln(2 pi e) / 2
  return half_log_determinant + kHalfLog2PiE * static_cast<double>(covariance.rows());
}

}  // namespace camera_self_calibration
