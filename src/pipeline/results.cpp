#include "camera_self_calibration/pipeline/results.h"

#include <cmath>
#include <cstdio>

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
  }
  return "";
}

std::string describe(const ShutterReport& shutter) {
  char text[160];
  const double readout_ms = 1e3 * shutter.readout_s;
  const double sigma_ms = 1e3 * shutter.sigma_s;
  if (sigma_ms == 0.0) {
    std::snprintf(text, sizeof(text), "%s, %.3f ms from the first row to the last (given)",
                  shutter.rolls ? "rolling" : "global", readout_ms);
  } else if (!std::isfinite(sigma_ms)) {
    std::snprintf(text, sizeof(text), "taken for global, nothing is known yet");
  } else if (shutter.rolls) {
    std::snprintf(text, sizeof(text), "rolling, %.3f ms from the first row to the last, sigma %.3f",
                  readout_ms, sigma_ms);
  } else {
    std::snprintf(text, sizeof(text), "global: %.3f ms from the first row to the last, sigma %.3f",
                  readout_ms, sigma_ms);
  }
  return text;
}

}  // namespace camera_self_calibration
