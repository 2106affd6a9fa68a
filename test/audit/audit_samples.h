#pragma once

#include <memory>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/audit/audit.h"
#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {

/// Features all over the image, but for its border.
inline ImageWeights evenFeatures(const Camera& camera) {
  ImageWeights weights(camera.width(), camera.height());
  for (int row = 1; row + 1 < ImageField::kRows; ++row) {
    for (int column = 1; column + 1 < ImageField::kColumns; ++column) {
      weights.count(ImageField::pixel(column, row, camera.width(), camera.height()));
    }
  }
  return weights;
}

/// What is known of a lens: independent sigmas that move the image by `uncertainty_px` rms.
inline CalibrationReport knownLens(const Camera& estimate, double uncertainty_px) {
  CalibrationReport report;
  report.camera = estimate;
  report.state = CalibrationState::kConverged;
  report.handed_over = true;
  report.revision = 1;
  const int n = estimate.estimatedCount();
  const IntrinsicsMatrix metric = pixelMetric(estimate);
  report.covariance = IntrinsicsMatrix::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    report.covariance(i, i) = uncertainty_px * uncertainty_px / (n * metric(i, i));
  }
  report.uncertainty = pixelUncertainty(estimate, report.covariance);
  report.observed.features = std::make_shared<const ImageWeights>(evenFeatures(estimate));
  return report;
}

/// The lens with some parameters multiplied, and then added to.
inline Camera changed(const Camera& camera, double focal_factor, const Eigen::Vector2d& shift) {
  Camera result = camera;
  Intrinsics p = camera.parameters();
  p.head<2>() *= focal_factor;
  p.segment<2>(2) += shift;
  result.setParameters(p);
  return result;
}

}  // namespace camera_self_calibration
