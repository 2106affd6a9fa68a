// What rows that are read one after the other lead to: the part of BackEnd that learns the readout
// time of a rolling shutter.

#include <optional>
#include <vector>

#include "camera_self_calibration/map/rolling_shutter.h"
#include "camera_self_calibration/pipeline/back_end.h"

namespace camera_self_calibration {
namespace {

// Keyframes more in the startup batch, after which it is asked again.
constexpr int kKeyframesBetween = 3;
// Changes of the queue after which it is asked again, which takes three linearisations.
constexpr int kSwapsBetween = 5;

// With a global shutter there is nothing to free it of.
bool isGlobal(double row_time_s, const Segment& segment) {
  return segment.keyframes.empty() ||
         (segment.keyframes.front().row_time_s == 0.0 && row_time_s == 0.0);
}

// Before anything is known of the lens, features move as each was seen to.
void freeOf(double row_time_s, const Camera& camera, bool scene_known, Segment* segment) {
  if (isGlobal(row_time_s, *segment)) return;
  if (scene_known) {
    setRowTimeOfScene(row_time_s, camera, segment);
  } else {
    setRowTime(row_time_s, camera.height(), segment);
  }
}

}  // namespace

// The front end may know an older row time. Nothing where the message is good as it is.
std::optional<KeyframeMessage> BackEnd::freed(const KeyframeMessage& message) const {
  const double row_time_s = row_time_.inUse();
  if (isGlobal(row_time_s, message.candidate) && isGlobal(row_time_s, message.history)) {
    return std::nullopt;
  }
  KeyframeMessage result = message;
  const bool scene_known = handed_over_ || follows_queue_ || startup_.tellsLens();
  freeOf(row_time_s, report_.camera, scene_known, &result.candidate);
  freeOf(row_time_s, report_.camera, scene_known, &result.history);
  return result;
}

void BackEnd::considerRowTime() {
  if (!options_.estimate_readout) return;
  RowTimeEstimate estimate;
  if (handed_over_) {
    const int wanted = row_time_.settled() ? kSwapsBetween : 1;
    if (swaps_since_row_time_ < wanted || !solution_.usable) return;
    // One that is settled can wait for a keyframe that did not solve the queue already.
    if (row_time_.settled() && report_.queue.last_accepted) return;
    swaps_since_row_time_ = 0;
    estimate = estimate_.rowTime(solution_);
  } else {
    const int keyframes = startup_.keyframesAdded();
    if (row_time_.settled() && keyframes < row_time_keyframes_ + kKeyframesBetween) return;
    row_time_keyframes_ = keyframes;
    estimate = startup_.rowTime();
  }
  if (row_time_.take(estimate)) adoptRowTime();
}

// The queue's segments stay, evaluated anew; none that was well posed is lost by it.
void BackEnd::adoptRowTime() {
  const double row_time_s = row_time_.inUse();
  if (!handed_over_) startup_.setRowTime(row_time_s);
  detector_.reset();
  const std::vector<Candidate> candidates = estimate_.candidates();
  const int swaps = report_.queue.swaps;
  queue_.clear();
  estimate_.clear();
  for (const Candidate& candidate : candidates) {
    Candidate anew = withRowTime(candidate, row_time_s, report_.camera);
    if (!anew.well_posed) {
      anew = candidate;
      freeOf(row_time_s, report_.camera, true, &anew.segment);
    }
    offer(anew);
  }
  report_.queue.swaps = swaps;
  swaps_since_row_time_ = 0;
  if (!estimate_.candidates().empty()) solveQueue();
  if (!handed_over_) followTheBetter();
  changed_ = true;
}

// A readout time that was given is believed rather than one that was learnt.
void BackEnd::restoreShutter(const LearntState& state) {
  if (!options_.estimate_readout) return;
  row_time_ = RowTime(state.row_time_s, rowSteps(state.camera.height()));
  RowTimeEstimate known;
  known.usable = state.row_time_sigma_s > 0.0;
  known.row_time_s = state.row_time_s;
  known.sigma_s = state.row_time_sigma_s;
  row_time_.restore(known);
}

void BackEnd::reportShutter() {
  const int steps = rowSteps(report_.camera.height());
  ShutterReport& shutter = report_.shutter;
  shutter.rolls = row_time_.inUse() != 0.0;
  if (!options_.estimate_readout) {
    shutter.readout_s = options_.readout_s;
    shutter.sigma_s = 0.0;
  } else if (row_time_.estimate().usable) {
    shutter.readout_s = steps * row_time_.estimate().row_time_s;
    shutter.sigma_s = steps * row_time_.estimate().sigma_s;
  }
}

}  // namespace camera_self_calibration
