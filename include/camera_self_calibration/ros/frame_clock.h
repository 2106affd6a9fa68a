#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace camera_self_calibration {

/// What the time between images tells: their rate, how many of them did not arrive, and long gaps.
class FrameClock {
 public:
  struct Step {
    int missed = 0;    ///< Images that would have fitted in between, had the rate been kept.
    bool gap = false;  ///< Longer than a second and five periods: the camera was silent.
  };

  /// The time from one image to the next [ns], > 0.
  Step add(std::int64_t step_ns);

  /// As after a restart of the camera: another rate may hold.
  void clear() { count_ = 0; }

  /// Images per second, by the mean of the usual steps; 0 until five steps are known.
  double rate() const;

 private:
  static constexpr std::size_t kKept = 15;

  std::int64_t period() const;

  std::array<std::int64_t, kKept> steps_{};
  std::size_t count_ = 0;
};

}  // namespace camera_self_calibration
