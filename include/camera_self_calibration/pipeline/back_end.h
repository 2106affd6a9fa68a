#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/lens_change/change_detector.h"
#include "camera_self_calibration/pipeline/back_end_state.h"
#include "camera_self_calibration/pipeline/front_end.h"
#include "camera_self_calibration/pipeline/handover.h"
#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/queue/candidate_window.h"
#include "camera_self_calibration/queue/segment_queue.h"

namespace camera_self_calibration {

struct BackEndOutput {
  CalibrationReport report;
  std::optional<CalibrationUpdate> update;
  std::vector<Event> events;
};

/// Thread 2: from keyframes to intrinsics (fig. 3). A startup batch first; the queue is filled
/// meanwhile and takes over when its estimate is good enough and its segments agree. Learning
/// begins again when the lens changes. Phase says whose intrinsics count.
class BackEnd {
 public:
  /// Learns from nothing but `camera`, where to start. Counts on from `counters`.
  BackEnd(const Options& options, const Camera& camera, const Counters& counters = {});

  /// Goes on from a saved queue, solved again, until confirm(). False, and nothing changed, if it
  /// is of another camera model or image size, or has no solution, or if something is known
  /// already.
  bool restore(const LearntState& state);

  BackEndOutput process(const KeyframeMessage& seen);

  /// Says what is known and that a keyframe came, but learns nothing from it. `remark` is added to
  /// all sentences.
  BackEndOutput hold(const KeyframeMessage& message, const std::string& remark);

  /// New images agree with the restored queue, which is offered the segments that they gave.
  BackEndOutput confirm(const std::vector<Candidate>& candidates);

  const BackEndState& state() const { return state_; }

 private:
  void see(const KeyframeMessage& message);
  void runStartup(const Segment& history);
  void keepFinishedBatch();
  void followTheBetter();
  CandidateOutcome considerCandidate(const KeyframeMessage& message);
  std::optional<CandidateOutcome> canSkipSolve(const KeyframeMessage& message);
  CandidateOutcome offer(const Candidate& candidate);
  CandidateOutcome followDrift(const ChangeVerdict& verdict);
  void considerWrongSegment();
  void considerDrift();
  void recallSetting();
  void considerLineDelay();
  void adoptLineDelay();
  void considerHandover();
  HandoverLimits handoverLimits() const;
  void offerHalves();
  void judge();
  BackEndOutput finish();

  // In lens_model.cpp.
  void considerStartupModel();
  void considerLensFit();
  std::optional<LensComparison> compareLens(bool verdict_due);
  bool chooseModel(const LensComparison& comparison);
  bool gainK3(const LensComparison& comparison);
  bool switchModel(const LensTrial& lens);

  // In beginnings.cpp.
  CandidateOutcome beginLens(const ChangeVerdict& verdict);
  void archiveQueue(std::int64_t onset_ns);

  void advance(PhaseTrigger trigger);
  void adoptStartup(const PixelError& uncertainty);
  void adoptSolution();
  void stateUncertainty();
  void adoptChange(int taken);
  void clearQueue();
  QueueStart queueStart() const;
  double convergedRms() const { return options_.convergedRms(state_.known.camera); }
  void raise(EventType type, const std::string& sentence);

  Options options_;
  BackEndState state_;
  bool changed_ = false;              // the estimate in use, by the newest keyframe
  bool converged_told_ = false;       // by an event
  std::int64_t halves_offered_ = -1;  // Segment::sequence of the batch
  std::vector<Event> events_;         // of the newest keyframe
};

}  // namespace camera_self_calibration
