#include "camera_self_calibration/pipeline/results.h"

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

}  // namespace camera_self_calibration
