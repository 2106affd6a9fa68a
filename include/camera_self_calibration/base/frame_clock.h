#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace camera_self_calibration {

/// What follows from the time between images: their rate, how many of them did not arrive, and long
/// gaps.
class FrameClock {
 public:
  /// `kept` steps, at least five, are averaged over: more are steadier, fewer follow a change of
  /// the rate sooner.
  explicit FrameClock(std::size_t kept = 15) : steps_(kept) {}

  struct Step {
    int missed = 0;    ///< Images that would have fitted in between, had the rate been kept.
    bool gap = false;  ///< Longer than a second and five periods: the camera was silent.
  };

  /// The time from one image to the next [ns], > 0.
  Step add(std::int64_t step_ns);

  /// As after a restart of the camera: another rate may hold.
  void clear() { count_ = 0; }

  /// The mean of the usual steps [ns]; 0 until five steps are known.
  std::int64_t period() const;

  /// Images per second; 0 until five steps are known.
  double rate() const;

 private:
  std::vector<std::int64_t> steps_;  // a ring
  std::size_t count_ = 0;
};

}  // namespace camera_self_calibration
