#include "camera_self_calibration/estimation/entropy.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <limits>

namespace camera_self_calibration {
namespace {

// Standard deviations of batch solutions over 100 keyframes each, mean of three: simulated
// hand-held camera in a furnished room, 640 x 480, 128 tracks, 0.1 px noise per axis; a lens of
// about 90 degrees (pinhole), 110 (fov), 80 (radtan) and 125 (equidistant). Per unit of the image's
// longer side for fx, fy, cx, cy; then the distortion's own units.
struct NormalizationTable {
  CameraModel model;
  std::array<double, kMaxIntrinsics> sigma;
};

constexpr NormalizationTable kTables[] = {
    {CameraModel::kPinhole, {3.4e-5, 3.6e-5, 2.8e-5, 3.2e-5}},
    {CameraModel::kFov, {5.2e-5, 5.3e-5, 7.7e-5, 8.0e-5, 4.4e-5}},
    {CameraModel::kRadtan,
     {8.8e-5, 9.0e-5, 1.1e-4, 1.5e-4, 1.1e-4, 1.6e-4, 1.3e-5, 1.1e-5, 6.8e-5}},
    {CameraModel::kEquidistant, {4.7e-5, 4.9e-5, 5.2e-5, 5.5e-5, 3.2e-4, 7.2e-4, 6.3e-4, 1.9e-4}},
};

}  // namespace

Intrinsics normalizationSigmas(const Camera& camera) {
  for (const NormalizationTable& table : kTables) {
    if (table.model != camera.model()) continue;
    Intrinsics sigmas(camera.estimatedCount());
    for (int i = 0; i < sigmas.size(); ++i) {
      sigmas(i) = table.sigma[i] * (i < 4 ? camera.longerSide() : 1.0);
    }
    return sigmas;
  }
  return Intrinsics::Ones(camera.estimatedCount());
}

double entropy(const Camera& camera, const IntrinsicsMatrix& covariance) {
  const Intrinsics inverse = normalizationSigmas(camera).cwiseInverse();
  if (covariance.rows() != inverse.size() || covariance.cols() != inverse.size()) {
    return std::numeric_limits<double>::infinity();
  }
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
