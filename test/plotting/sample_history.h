#pragma once

#include <cmath>

#include "camera_self_calibration/plotting/convergence_history.h"

namespace camera_self_calibration {

/// A report as of a run that converges: errors and sigmas fall with the square root of time.
inline CalibrationReport sampleReport(CameraModel model, int i) {
  CalibrationReport report;
  report.stamp_ns = 1000000000LL + i * 250000000LL;
  report.camera = Camera::defaultGuess(model, 640, 480);
  Intrinsics values = report.camera.parameters();
  const Eigen::Index n = values.size();
  report.covariance = IntrinsicsMatrix::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double sigma = (k < 4 ? 2.0 : 0.005) / std::sqrt(1.0 + i);
    values[k] += sigma * std::sin(0.37 * i + static_cast<double>(k));
    report.covariance(k, k) = sigma * sigma;
  }
  report.camera.setParameters(values);
  report.uncertainty = {3.0 / std::sqrt(1.0 + i), 9.0 / std::sqrt(1.0 + i)};
  report.handed_over = i >= 20;
  report.state = i < 20   ? CalibrationState::kInitializing
                 : i < 30 ? CalibrationState::kConverging
                          : CalibrationState::kConverged;
  report.sentence = "the expected error is small enough";
  report.revision = static_cast<std::uint64_t>(i);
  for (int s = 0; s < std::min(i / 3, 10); ++s) {
    const std::int64_t begin = 1000000000LL + s * 700000000LL;
    report.queue.segments.push_back({s, begin, begin + 1200000000LL, 5.0 + 0.4 * s, 10, 90, 600});
  }
  return report;
}

inline ConvergenceHistory sampleHistory(CameraModel model, int reports) {
  ConvergenceHistory history;
  for (int i = 0; i < reports; ++i) history.add(sampleReport(model, i));
  return history;
}

}  // namespace camera_self_calibration
