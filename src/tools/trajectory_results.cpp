#include "camera_self_calibration/tools/trajectory_results.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/simulation/tum_file.h"

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kEndOfTime = std::numeric_limits<std::int64_t>::max();

std::vector<StampedCameraPose> posesOf(const std::vector<TimedPose>& timed) {
  return {timed.begin(), timed.end()};
}

std::string shareText(const char* when, const std::optional<TrajectoryDifference>& difference) {
  if (!difference) return {};
  return formatted(
      "  %s: %.3f %% of the way apart from the run with the reference calibration "
      "(mean over %d poses)\n",
      when, 100.0 * difference->share(), difference->poses);
}

Json differenceJson(const std::optional<TrajectoryDifference>& difference) {
  if (!difference) return {};
  return {{"poses", difference->poses},
          {"travelled", difference->travelled},
          {"scale", difference->scale},
          {"mean", difference->mean},
          {"ate_rms", difference->rms},
          {"max", difference->max},
          {"share_of_way", difference->share()},
          {"rpe_seconds", difference->interval_s},
          {"rpe_translation_rms", difference->relative_translation},
          {"rpe_rotation_deg_rms", difference->relative_rotation_deg}};
}

std::string relativeText(const TrajectoryDifference& difference) {
  if (!std::isfinite(difference.relative_translation)) {
    return formatted("unknown (no poses %.0f s apart)", difference.interval_s);
  }
  return formatted("%.4f and %.3f deg over %.0f s", difference.relative_translation,
                   difference.relative_rotation_deg, difference.interval_s);
}

}  // namespace

std::string truthText(const char* what, const std::optional<TrajectoryDifference>& difference) {
  if (!difference) return {};
  return formatted("  %s: ATE %.4f, RPE %s; %.1f travelled\n", what, difference->rms,
                   relativeText(*difference).c_str(), difference->travelled);
}

TrajectoryResults compareTrajectories(const Recording& recording,
                                      const std::vector<StampedCameraPose>& ground_truth) {
  TrajectoryResults results;
  for (const Event& event : recording.events) {
    if (event.type == EventType::kHandover && !results.handover_ns) {
      results.handover_ns = event.stamp_ns;
    }
  }
  const std::vector<StampedCameraPose> own = posesOf(recording.poses);
  const std::vector<StampedCameraPose> held = posesOf(recording.reference_poses);
  const std::int64_t handover = results.handover_ns.value_or(kEndOfTime);
  const auto later = between(own, handover, kEndOfTime);
  results.startup = compareTrajectories(between(own, 0, handover), held);
  results.later = compareTrajectories(later, held);
  results.truth = compareTrajectories(own, ground_truth);
  results.truth_later = compareTrajectories(later, ground_truth);
  results.truth_reference =
      compareTrajectories(between(held, results.handover_ns.value_or(0), kEndOfTime), ground_truth);
  return results;
}

std::vector<StampedCameraPose> readGroundTruth(const std::string& path) {
  std::vector<StampedCameraPose> poses;
  for (const StampedPose& pose : readTum(path)) {
    poses.push_back({std::llround(1e9 * pose.time_s), 0, pose.world_from_body});
  }
  std::sort(poses.begin(), poses.end(), [](const StampedCameraPose& a, const StampedCameraPose& b) {
    return a.stamp_ns < b.stamp_ns;
  });
  return poses;
}

std::string trajectoryText(const TrajectoryResults& results) {
  std::string text = shareText("until hand-over", results.startup) +
                     shareText("after hand-over", results.later) +
                     truthText("from the ground truth, whole run", results.truth) +
                     truthText("from the ground truth, after hand-over", results.truth_later) +
                     truthText("the same with the reference calibration", results.truth_reference);
  return text.empty() ? text : kTrajectoryHeading + text;
}

Json trajectoryJson(const TrajectoryResults& results) {
  return {{"reference_until_handover", differenceJson(results.startup)},
          {"reference_after_handover", differenceJson(results.later)},
          {"ground_truth", differenceJson(results.truth)},
          {"ground_truth_after_handover", differenceJson(results.truth_later)},
          {"ground_truth_with_reference_calibration", differenceJson(results.truth_reference)}};
}

}  // namespace camera_self_calibration
