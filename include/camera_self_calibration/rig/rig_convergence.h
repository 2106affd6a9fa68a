#pragma once

#include <cstdint>
#include <optional>

#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/rig/rig_session.h"

namespace camera_self_calibration {

/// Notices in the reports of a rig when it becomes CONVERGED and when it no longer is.
class RigConvergence {
 public:
  /// CONVERGED or NO_LONGER_CONVERGED where the report's state is another than the one before.
  /// Nothing where a lens or a mount changed, since a new epoch has an event of its own, and
  /// nothing for a report that a newer one has overtaken: they come from several threads.
  std::optional<Event> next(const RigReport& report);

 private:
  bool converged_ = false;
  std::uint64_t epoch_ = 0;
  std::uint64_t revision_ = 0;
};

}  // namespace camera_self_calibration
