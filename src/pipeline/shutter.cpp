#include "camera_self_calibration/pipeline/shutter.h"

#include <cstdlib>

#include "camera_self_calibration/map/rolling_shutter.h"

namespace camera_self_calibration {
namespace {

// Keyframes more in the startup batch, after which it is asked again: another row time means that
// all segments are evaluated anew.
constexpr int kKeyframesBetween = 3;
// Changes of the queue, likewise.
constexpr int kTakenBetween = 5;

// With a global shutter there is nothing to free it of.
bool isGlobal(double row_time_s, const Segment& segment) {
  return segment.keyframes.empty() ||
         (segment.keyframes.front().row_time_s == 0.0 && row_time_s == 0.0);
}

void freeOf(double row_time_s, const Camera& camera, bool scene_known, Segment* segment) {
  if (isGlobal(row_time_s, *segment)) return;
  if (scene_known) {
    setRowTimeOfScene(row_time_s, camera, segment);
  } else {
    setRowTime(row_time_s, camera.height(), segment);
  }
}

}  // namespace

Shutter::Shutter(const Options& options, int rows)
    : learns_(options.estimate_readout),
      given_readout_s_(options.readout_s),
      row_steps_(rowSteps(rows)),
      row_time_(given_readout_s_ / row_steps_, row_steps_) {}

KeyframeMessage Shutter::freed(const KeyframeMessage& message, const Camera& camera,
                               bool scene_known) const {
  KeyframeMessage result = message;
  freeOf(row_time_.inUse(), camera, scene_known, &result.candidate);
  freeOf(row_time_.inUse(), camera, scene_known, &result.history);
  return result;
}

Candidate Shutter::freed(const Candidate& candidate, const Camera& camera) const {
  Candidate anew = withRowTime(candidate, row_time_.inUse(), camera);
  if (anew.well_posed) return anew;
  anew = candidate;
  freeOf(row_time_.inUse(), camera, true, &anew.segment);
  return anew;
}

std::vector<Candidate> Shutter::freed(const std::vector<Candidate>& candidates,
                                      const Camera& camera) const {
  std::vector<Candidate> result;
  for (const Candidate& candidate : candidates) result.push_back(freed(candidate, camera));
  return result;
}

bool Shutter::ask(const Startup& startup) {
  if (!learns_) return false;
  const int keyframes = startup.keyframesAdded();
  const bool known = row_time_.estimate().usable;
  if (known && std::abs(keyframes - keyframes_) < kKeyframesBetween) return false;
  keyframes_ = keyframes;
  return row_time_.take(startup.rowTime());
}

bool Shutter::ask(const SegmentQueue& queue, bool just_solved) {
  if (!learns_ || !queue.solution().usable) return false;
  if (taken_ < (row_time_.settled() ? kTakenBetween : 1)) return false;
  // One that is settled can wait for a cheaper keyframe.
  if (row_time_.settled() && just_solved) return false;
  taken_ = 0;
  return row_time_.take(queue.rowTime());
}

void Shutter::restore(const LearntState& state) {
  if (!learns_) return;
  row_time_ = RowTime(state.row_time_s, row_steps_);
  RowTimeEstimate known;
  known.usable = state.row_time_sigma_s > 0.0;
  known.row_time_s = state.row_time_s;
  known.sigma_s = state.row_time_sigma_s;
  row_time_.restore(known);
}

QueueStart Shutter::startFrom(const Camera& camera) const {
  return {camera, row_time_.estimate(), row_time_.doubt()};
}

ShutterReport Shutter::report() const {
  ShutterReport report;
  report.rolls = row_time_.inUse() != 0.0;
  if (!learns_) {
    report.readout_s = given_readout_s_;
    report.sigma_s = 0.0;
  } else if (row_time_.estimate().usable) {
    report.readout_s = row_steps_ * row_time_.estimate().row_time_s;
    report.sigma_s = row_steps_ * row_time_.estimate().sigma_s;
  }
  return report;
}

}  // namespace camera_self_calibration
