#include "camera_self_calibration/rig/rig_convergence.h"

#include <utility>

namespace camera_self_calibration {

std::optional<Event> RigConvergence::next(const RigReport& report) {
  if (report.revision < revision_ || report.epoch < epoch_) return std::nullopt;
  revision_ = report.revision;
  const bool same_epoch = std::exchange(epoch_, report.epoch) == report.epoch;
  const bool now = report.state == CalibrationState::kConverged;
  const bool before = std::exchange(converged_, now) && same_epoch;
  if (now == before || report.estimate.poses.empty()) return std::nullopt;
  const std::int64_t stamp_ns = report.estimate.poses.back().stamp_ns;
  return Event{now ? EventType::kConverged : EventType::kNoLongerConverged, stamp_ns, stamp_ns,
               report.sentence};
}

}  // namespace camera_self_calibration
