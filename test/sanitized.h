#pragma once

namespace camera_self_calibration {

/// Whether a sanitizer slows the tests down by a factor of ten or more: those that repeat a run for
/// statistics repeat it less often then.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

}  // namespace camera_self_calibration
