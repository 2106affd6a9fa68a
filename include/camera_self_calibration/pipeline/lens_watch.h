#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "camera_self_calibration/lens_change/change_detector.h"
#include "camera_self_calibration/pipeline/front_end.h"
#include "camera_self_calibration/queue/agreement.h"
#include "camera_self_calibration/queue/candidate_outlook.h"
#include "camera_self_calibration/queue/candidate_window.h"
#include "camera_self_calibration/queue/segment_queue.h"
#include "camera_self_calibration/startup/startup.h"

namespace camera_self_calibration {

/// Watches whether the lens is still the one that is being learnt: after hand-over against the
/// queue, before it against what the startup batch said before the newest window began.
class LensWatch {
 public:
  /// Alarms per hour while nothing changes; 0: never any alarm.
  explicit LensWatch(double false_alarms_per_hour) : detector_(false_alarms_per_hour) {}

  /// The window began before the present lens did.
  bool straddlesChange(const Segment& window) const { return window.beginNs() < onset_ns_; }
  /// Stamp of the first keyframe with the present lens [ns]; 0 for the first lens.
  std::int64_t onsetNs() const { return onset_ns_; }

  /// For a window that will not enter the queue: its p-value if it says nothing against the lens,
  /// so that it need not be solved. `handed_over`: the queue is what it is held against.
  std::optional<double> clearlySame(const KeyframeMessage& message, const CandidateOutlook& outlook,
                                    const SegmentQueue& queue, bool handed_over);

  /// What the window says of the lens, as it came (in `message`) and as a solved candidate.
  ChangeVerdict examine(const KeyframeMessage& message, const Candidate& candidate,
                        const SegmentQueue& queue, bool handed_over);

  /// Keeps what the startup batch says at a keyframe if that is good enough to hold later windows
  /// against it. The batch holds the newest keyframes too, so that what came before them has to be
  /// remembered. `uncertainty` of the batch, `converged_rms`: that of CONVERGED [px].
  void remember(std::int64_t stamp_ns, const Startup& startup, const PixelError& uncertainty,
                double converged_rms);
  /// What was remembered rested on a start that was wrong, or on another model.
  void forgetStartup() { course_.clear(); }

  /// Windows so far were freed of another line delay.
  void forgetWindows() { detector_.reset(); }

  /// The clock was set back: stamps so far compare with none to come.
  void forgetStamps();

  /// A new lens since `onset_ns`. `scatter`: by how much the old one's segments disagreed; nothing
  /// without a queue.
  void beginLens(std::int64_t onset_ns, const std::optional<Scatter>& scatter);

  /// How the lens drifts, from the queue and the newest windows beside it; queue.solution() must
  /// be usable. `now_ns`: stamp of the newest keyframe.
  LensDrift drift(const SegmentQueue& queue, std::int64_t now_ns) const {
    return detector_.drift(queue, now_ns);
  }
  /// A segment of the queue that all others contradict (ChangeDetector::wrongSegment).
  std::optional<std::int64_t> wrongSegment(const SegmentQueue& queue, std::int64_t now_ns) const {
    return detector_.wrongSegment(queue, now_ns);
  }
  /// The newest keyframe can have changed both, though it did not change the queue.
  bool hasNews() const { return detector_.hasNews(); }

 private:
  std::optional<Reference> knownBefore(std::int64_t stamp_ns) const;

  ChangeDetector detector_;
  std::deque<std::pair<std::int64_t, Reference>> course_;  // of the startup batch, by stamp
  double residual_scale_ = 1.0;  // of the batch when it was last remembered
  // How far segments of this camera scatter, as its model does not describe it exactly: that of the
  // queue before the newest change; of the first lens, before there is a queue, three sigmas.
  Scatter usual_scatter_ = {40.0 * 3.0 * 3.0, 40};
  bool first_lens_ = true;
  std::int64_t onset_ns_ = 0;
};

}  // namespace camera_self_calibration
