#include "camera_self_calibration/pipeline/shutter.h"

#include <algorithm>
#include <cstdlib>

#include "camera_self_calibration/base/parallel.h"
#include "camera_self_calibration/map/rolling_shutter.h"

namespace camera_self_calibration {
namespace {

// Keyframes more in the startup batch, at least, after which it is asked again: another line delay
// means that all segments are evaluated anew.
constexpr int kKeyframesBetween = 3;
// Changes of the queue, likewise.
constexpr int kTakenBetween = 5;

// With a global shutter there is nothing to free it of.
bool isGlobal(double line_delay_s, const Segment& segment) {
  return segment.keyframes.empty() ||
         (segment.keyframes.front().line_delay_s == 0.0 && line_delay_s == 0.0);
}

void freeOf(double line_delay_s, const Camera& camera, bool scene_known, Segment* segment) {
  if (isGlobal(line_delay_s, *segment)) return;
  if (scene_known) {
    setLineDelayOfScene(line_delay_s, camera, segment);
  } else {
    setLineDelay(line_delay_s, camera.height(), segment);
  }
}

}  // namespace

Shutter::Shutter(const Options& options, int rows)
    : learns_(options.estimate_readout),
      given_readout_s_(options.readout_s),
      row_steps_(rowSteps(rows)),
      threads_(options.solver_threads),
      line_delay_(given_readout_s_ / row_steps_, row_steps_) {}

KeyframeMessage Shutter::freed(const KeyframeMessage& message, const Camera& camera,
                               bool scene_known) const {
  KeyframeMessage result = message;
  freeOf(line_delay_.inUse(), camera, scene_known, &result.candidate);
  freeOf(line_delay_.inUse(), camera, scene_known, &result.history);
  return result;
}

Candidate Shutter::freed(const Candidate& candidate, const Camera& camera) const {
  Candidate anew = withLineDelay(candidate, line_delay_.inUse(), camera);
  if (anew.well_posed) return anew;
  anew = candidate;
  freeOf(line_delay_.inUse(), camera, true, &anew.segment);
  return anew;
}

std::vector<Candidate> Shutter::freed(const std::vector<Candidate>& candidates,
                                      const Camera& camera) const {
  std::vector<Candidate> result(candidates.size());
  parallelFor(threads_, static_cast<int>(candidates.size()),
              [&](int i) { result[i] = freed(candidates[i], camera); });
  return result;
}

bool Shutter::ask(const Startup& startup) {
  if (!learns_) return false;
  const int keyframes = startup.keyframesAdded();
  const bool known = line_delay_.estimate().usable;
  const int between = std::max(kKeyframesBetween, static_cast<int>(kWorthASolve * keyframes));
  if (known && std::abs(keyframes - keyframes_) < between) return false;
  keyframes_ = keyframes;
  return line_delay_.take(startup.lineDelay());
}

bool Shutter::ask(const SegmentQueue& queue, bool just_solved) {
  if (!learns_ || !queue.solution().usable) return false;
  if (taken_ < (line_delay_.settled() ? kTakenBetween : 1)) return false;
  // One that is settled can wait for a cheaper keyframe.
  if (line_delay_.settled() && just_solved) return false;
  taken_ = 0;
  return line_delay_.take(queue.lineDelay());
}

int Shutter::solve(const std::vector<Candidate>& candidates, const Camera& start,
                   SegmentQueue* queue) {
  int taken = queue->rebuild(freed(candidates, start), {start});
  if (learns_ && queue->solution().usable) {
    line_delay_.take(queue->lineDelay());
    const Camera solved = queue->solution().camera;
    taken = queue->rebuild(freed(candidates, solved), startFrom(solved));
  }
  noteFreed();
  return taken;
}

void Shutter::restore(const LearntState& state) {
  if (!learns_) return;
  line_delay_ = LineDelay(state.line_delay_s, row_steps_);
  LineDelayEstimate known;
  known.usable = state.line_delay_sigma_s > 0.0;
  known.line_delay_s = state.line_delay_s;
  known.sigma_s = state.line_delay_sigma_s;
  line_delay_.restore(known);
}

QueueStart Shutter::startFrom(const Camera& camera) const {
  return {camera, line_delay_.estimate(), line_delay_.doubt()};
}

ShutterReport Shutter::report() const {
  ShutterReport report;
  report.rolls = line_delay_.inUse() != 0.0;
  if (!learns_) {
    report.readout_s = given_readout_s_;
    report.sigma_s = 0.0;
  } else if (line_delay_.estimate().usable) {
    report.readout_s = row_steps_ * line_delay_.estimate().line_delay_s;
    report.sigma_s = row_steps_ * line_delay_.estimate().sigma_s;
  }
  return report;
}

}  // namespace camera_self_calibration
