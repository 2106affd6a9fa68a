#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "camera_self_calibration/pipeline/results.h"

namespace camera_self_calibration {

/// How far a run over stored images has come, in words.
struct ProgressState {
  std::int64_t frames = 0;
  std::int64_t total = 0;  ///< 0: not known.
  double elapsed_seconds = 0.0;
};

/// "frame 120/800 | 210 fps | fx 311.23 ± 0.42 px | CONVERGING | 3 s left".
std::string progressLine(const ProgressState& state, const CalibrationReport& report);

/// Keeps one line of a terminal up to date; silent if standard error is none.
class Progress {
 public:
  explicit Progress(std::int64_t total);

  /// Counts an image, whether it could be read or not.
  void advance() { ++state_.frames; }
  /// Redraws a few times a second at most.
  void show(const CalibrationReport& report, bool at_once = false);
  /// Ends the line.
  void finish();
  double elapsedSeconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  bool is_terminal_;
  ProgressState state_;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point shown_;
};

}  // namespace camera_self_calibration
