#pragma once

#include <cstdint>
#include <optional>

#include "camera_self_calibration/audit/audit.h"

namespace camera_self_calibration {

/// Since when a calibration is wrong: remembers when it was good last.
class AuditHistory {
 public:
  /// Sets `since_ns` of an audit that rests on `live`. A change of the lens after the last GOOD
  /// dates it; else it is wrong since the last GOOD.
  void date(const CalibrationReport& live, AuditReport* audit);

 private:
  struct Good {
    std::int64_t stamp_ns;
    std::uint64_t epoch;
  };
  std::optional<Good> good_;  // the last
  std::optional<std::int64_t> since_ns_;
};

}  // namespace camera_self_calibration
