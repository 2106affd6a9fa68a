#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "benchmark/degenerate_motion.h"
#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

/// One run of the whole system, but for the images, on simulated feature tracks (noise 0.1 to
/// 0.3 px, up to 2 % outliers).
struct DegenerateTrial {
  Camera truth;
  Degeneracy degeneracy = Degeneracy::kStanding;
  double degenerate_s = 60.0;
  double good_s = 20.0;     ///< Hand-held motion after it, or before it.
  bool good_first = false;  ///< Good motion first, and the degenerate one after it.
  bool skip_first = false;  ///< Begins when the first of the two is over: what to compare with.
  std::uint64_t seed = 1;
  double rate_hz = 15.0;
};

/// What a stretch of the run cost.
struct Expense {
  double begin_s = 0.0;
  int frames = 0;
  int keyframes = 0;
  double frame_ms = 0.0;     ///< CPU time per frame that is no keyframe, mean.
  double keyframe_ms = 0.0;  ///< ... per keyframe, mean.
  double slowest_ms = 0.0;   ///< ... of one frame.
  double memory_kb = 0.0;    ///< Held at its end by the system under trial.
};

struct DegenerateOutcome {
  int keyframes = 0;          ///< In the degenerate part.
  std::string states;         ///< Initials of the states reported there: W, I, D, c, C.
  std::string state;          ///< At the end of it.
  std::string final_state;    ///< At the end of all.
  std::string sentence;       ///< At the end of the degenerate part.
  int unfinished = 0;         ///< Reports there before hand-over, from 12 keyframes on.
  int hinted = 0;             ///< ... with the motion that would help.
  int named = 0;              ///< ... that name what is known least.
  double converged_s = -1;    ///< Since the degenerate part began; negative: not in it.
  double recovered_s = -1;    ///< First CONVERGED since the good motion began; negative: never.
  int published = 0;          ///< Reports of CONVERGED: what goes out as CameraInfo.
  double worst_ratio = 0.0;   ///< Of those, largest error over stated uncertainty, both px rms.
  double worst_sigmas = 0.0;  ///< ... and largest error of a parameter over its sigma.
  /// ... with an error over 5 sigma and over 1 px rms.
  bool false_converged = false;
  /// From a second after the good motion began, in what is CONVERGED: between the estimated and the
  /// true direction in which the camera went over 0.3 s, median of the images; NaN without any.
  double travel_deg = std::numeric_limits<double>::quiet_NaN();
  double error_px = 0.0;   ///< At the end, rms.
  double stated_px = 0.0;  ///< At the end, rms.
  /// Good first: most that the published calibration moved once the passage to the degenerate
  /// motion was over, rms.
  double wander_px = 0.0;
  int changes = 0;         ///< Events CALIBRATION_CHANGE.
  int left_converged = 0;  ///< Good first: reports after CONVERGED that are not.
  int lost = 0;            ///< Events LOST.
  double cpu_s = 0.0;
  std::vector<Expense> expenses;
};

/// `expense_s`: length of the stretches of which the cost is told [s].
DegenerateOutcome run(const DegenerateTrial& trial, double expense_s);

}  // namespace camera_self_calibration
