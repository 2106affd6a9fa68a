#pragma once

#include <Eigen/Cholesky>
#include <cstdint>
#include <vector>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/fleet/epochs.h"
#include "camera_self_calibration/fleet/spread.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {

inline Camera madeLens() { return camera640(CameraModel::kFov, {300, 302, 318, 242, 0.95}); }

inline Intrinsics valuesOf(const Camera& lens) {
  return lens.parameters().head(lens.estimatedCount());
}

/// A normal deviate with this covariance.
inline Intrinsics deviate(const IntrinsicsMatrix& covariance, Random* random) {
  Intrinsics white(covariance.rows());
  for (Eigen::Index i = 0; i < white.size(); ++i) white(i) = random->normal();
  const Eigen::MatrixXd root = Eigen::LLT<Eigen::MatrixXd>(covariance).matrixL();
  return root * white;
}

/// An estimate of `truth` that is `sigma_px` rms off as it says, and `tau_px` beyond that.
inline Estimate madeEstimate(const Intrinsics& truth, double sigma_px, double tau_px,
                             Random* random) {
  static const IntrinsicsMatrix unit = pixelUnit(madeLens());
  Estimate estimate;
  estimate.covariance = sigma_px * sigma_px * unit;
  estimate.value = truth + deviate((sigma_px * sigma_px + tau_px * tau_px) * unit, random);
  estimate.freedom = 50;
  return estimate;
}

/// The lens with a longer focal length.
inline Intrinsics zoomed(double factor) {
  Intrinsics values = valuesOf(madeLens());
  values.head<2>() *= factor;
  return values;
}

/// Bags of a camera with these focal lengths, relative to the lens.
inline EstimateSeries madeSeries(const std::vector<double>& zooms, double sigma_px, double tau_px,
                                 std::uint64_t seed) {
  Random random(seed);
  EstimateSeries series{madeLens(), {}};
  for (const double zoom : zooms) {
    // Good bags and bad ones.
    const double sigma = sigma_px * std::exp(0.5 * random.normal());
    series.estimates.push_back(madeEstimate(zoomed(zoom), sigma, tau_px, &random));
  }
  return series;
}

}  // namespace camera_self_calibration
