#include "camera_self_calibration/tools/progress.h"

#include <unistd.h>

#include <cmath>
#include <iomanip>
#include <iostream>
#include <sstream>

namespace camera_self_calibration {

std::string progressLine(const ProgressState& state, const CalibrationReport& report) {
  const double rate =
      state.elapsed_seconds > 0.0 ? static_cast<double>(state.frames) / state.elapsed_seconds : 0.0;
  std::ostringstream line;
  line << std::fixed << "frame " << state.frames;
  if (state.total > 0) line << '/' << state.total;
  line << std::setprecision(0) << " | " << rate << " fps | ";
  if (report.covariance.rows() > 0) {
    line << std::setprecision(2) << "fx " << report.camera.parameters()[0] << " ± "
         << std::sqrt(report.covariance(0, 0)) << " px | ";
  }
  line << toString(report.state);
  if (state.total > state.frames && rate > 0.0) {
    line << " | " << std::setprecision(0)
         << std::ceil(static_cast<double>(state.total - state.frames) / rate) << " s left";
  }
  return line.str();
}

Progress::Progress(std::int64_t total) : is_terminal_(isatty(STDERR_FILENO) == 1) {
  state_.total = total;
}

void Progress::show(const CalibrationReport& report, bool at_once) {
  constexpr std::chrono::milliseconds kInterval(200);
  const Clock::time_point now = Clock::now();
  if (!is_terminal_ || (!at_once && now - shown_ < kInterval)) return;
  shown_ = now;
  state_.elapsed_seconds = elapsedSeconds();
  std::cerr << "\r\033[K" << progressLine(state_, report) << std::flush;
}

void Progress::finish() {
  if (is_terminal_) std::cerr << '\n';
}

double Progress::elapsedSeconds() const {
  return std::chrono::duration<double>(Clock::now() - begin_).count();
}

}  // namespace camera_self_calibration
