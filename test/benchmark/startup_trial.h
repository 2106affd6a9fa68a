#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "benchmark/trial_scene.h"
#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

/// One run of the whole system, but for the images, on simulated feature tracks.
struct StartupTrial {
  Camera truth;
  std::optional<Camera> initial;  ///< None: the default guess.
  Scene scene = Scene::kHandheld;
  Idle idle = Idle::kNone;
  double idle_s = 0.0;   ///< Comes before the motion [s].
  double good_s = 15.0;  ///< Of the motion, at most; CONVERGED ends the run earlier [s].
  std::uint64_t seed =
      1;  ///< Of room, motion, its speed, noise (0.1 to 0.3 px), outliers (to 2 %).
};

struct StartupOutcome {
  std::string state;         ///< At the end.
  double handover_s = -1.0;  ///< Since the start; negative: never.
  double converged_s = -1.0;
  bool lost = false;  ///< Tracking was lost at least once.
  int keyframes = 0;
  /// Cost of the queue's observations (not CONVERGED: of all keyframes since the idle ones) with
  /// the final intrinsics held, poses and landmarks solved, over that of a solve of everything that
  /// starts at the truth, less 1.
  double excess_cost = 0.0;
  double optimum_rms_px = 0.0;  ///< Pixel uncertainty at that optimum.
  double error_px = 0.0;        ///< Distance of the estimate from the truth, rms.
  double stated_px = 0.0;       ///< Stated uncertainty, rms.
  double worst_sigmas = 0.0;    ///< Largest error of a parameter over its stated sigma.
  /// In any report of CONVERGED the error was over 5 sigma and over 1 px rms.
  bool false_converged = false;
  double threshold_px = 1.0;  ///< CONVERGED at or below this uncertainty.
  int idle_keyframes = 0;
  double first_idle_ms = 0.0;  ///< CPU time per keyframe in the middle third of the idle ones.
  double last_idle_ms = 0.0;   ///< In the last third.
  double cpu_s = 0.0;          ///< Of the whole run.
};

StartupOutcome run(const StartupTrial& trial);

}  // namespace camera_self_calibration
