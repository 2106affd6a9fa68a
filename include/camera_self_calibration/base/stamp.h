#pragma once

#include <cstdint>

namespace camera_self_calibration {

/// [s]; of a time since 1970 good to 0.2 us.
inline double toSeconds(std::int64_t nanoseconds) {
  return 1e-9 * static_cast<double>(nanoseconds);
}

}  // namespace camera_self_calibration
