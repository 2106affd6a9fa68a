#include "camera_self_calibration/pipeline/results.h"

#include <cmath>

#include "camera_self_calibration/base/formatted.h"

namespace camera_self_calibration {

std::string toString(TrackingState state) {
  switch (state) {
    case TrackingState::kInitializing:
      return "INITIALIZING";
    case TrackingState::kTracking:
      return "TRACKING";
    case TrackingState::kLost:
      return "LOST";
  }
  return "";
}

std::string toString(EventType type) {
  switch (type) {
    case EventType::kCalibrationChange:
      return "CALIBRATION_CHANGE";
    case EventType::kHandover:
      return "HANDOVER";
    case EventType::kConverged:
      return "CONVERGED";
    case EventType::kLost:
      return "LOST";
    case EventType::kRelocalized:
      return "RELOCALIZED";
    case EventType::kInput:
      return "INPUT";
    case EventType::kMountChanged:
      return "MOUNT_CHANGED";
    case EventType::kNoLongerConverged:
      return "NO_LONGER_CONVERGED";
  }
  return "";
}

std::string describe(const ShutterReport& shutter) {
  const double readout_ms = 1e3 * shutter.readout_s;
  const double sigma_ms = 1e3 * shutter.sigma_s;
  if (sigma_ms == 0.0) {
    return formatted("%s, readout time %.3f ms (given)", shutter.rolls ? "rolling" : "global",
                     readout_ms);
  }
  if (!std::isfinite(sigma_ms)) return "assumed global; not estimated yet";
  return formatted(shutter.rolls ? "rolling, readout time %.3f ms, sigma %.3f ms"
                                 : "treated as global (readout time %.3f ms, sigma %.3f ms)",
                   readout_ms, sigma_ms);
}

}  // namespace camera_self_calibration
