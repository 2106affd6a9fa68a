#include "camera_self_calibration/queue/queue_solution.h"

namespace camera_self_calibration {

Camera QueueSolution::present() const {
  Camera now = camera;
  if (!drift.significant) return now;
  Intrinsics parameters = camera.parameters();
  parameters.head(drift.offset.size()) += drift.offset;
  now.setParameters(parameters);
  return now;
}

IntrinsicsMatrix QueueSolution::presentCovariance() const {
  if (!drift.significant) return covariance;
  // What the covariance allows for beyond the information: correlated errors, the line delay.
  const auto independent = covarianceFromInformation(information);
  return independent ? IntrinsicsMatrix(drift.covariance + covariance - *independent)
                     : drift.covariance;
}

void QueueSolution::addUncertaintyOf(const LineDelayEstimate& line_delay, double doubt_s) {
  if (!line_delay.usable || line_delay.slope.size() != covariance.rows()) return;
  const Intrinsics deviation = doubt_s * line_delay.slope;
  covariance += deviation * deviation.transpose();
}

}  // namespace camera_self_calibration
