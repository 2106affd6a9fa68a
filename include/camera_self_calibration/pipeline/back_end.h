#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/lens_change/setting_archive.h"
#include "camera_self_calibration/model_choice/lens_fit.h"
#include "camera_self_calibration/model_choice/model_choice.h"
#include "camera_self_calibration/pipeline/front_end.h"
#include "camera_self_calibration/pipeline/handover.h"
#include "camera_self_calibration/pipeline/health.h"
#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/pipeline/lens_watch.h"
#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/pipeline/phase.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/pipeline/shutter.h"
#include "camera_self_calibration/queue/candidate_window.h"
#include "camera_self_calibration/queue/segment_queue.h"
#include "camera_self_calibration/startup/startup.h"

namespace camera_self_calibration {

struct BackEndOutput {
  CalibrationReport report;
  std::optional<CalibrationUpdate> update;
  std::vector<Event> events;
};

/// What goes on counting whenever learning begins again, so that no number is given twice.
struct Counters {
  std::uint64_t revision = 0;  ///< Of the newest estimate.
  std::uint64_t epoch = 0;     ///< Of the lens.
};

/// Thread 2: from keyframes to intrinsics (fig. 3). A startup batch first; the queue is filled
/// meanwhile and takes over when its estimate is good enough and its segments agree. Learning
/// begins again when the lens changes. Phase tells whose intrinsics count.
class BackEnd {
 public:
  /// Learns from nothing but `camera`, where to start. Counts on from `counters`.
  BackEnd(const Options& options, const Camera& camera, const Counters& counters = {});

  /// Goes on from a saved queue, solved again, until confirm(). False, and nothing changed, if it
  /// is of another camera model or image size, or has no solution.
  bool restore(const LearntState& state);

  BackEndOutput process(const KeyframeMessage& seen);

  /// Says what is known and that a keyframe came, but learns nothing from it. `remark` is added to
  /// all sentences.
  BackEndOutput hold(const KeyframeMessage& message, const std::string& remark);

  /// New images agree with the restored queue, which is offered the segments that they gave.
  BackEndOutput confirm(const std::vector<Candidate>& candidates);

  /// The present estimate, for the front end.
  CalibrationUpdate update() const;

  /// All that was learnt; null until the queue has taken over.
  std::shared_ptr<const LearntState> state() const;

  Phase phase() const { return phase_; }
  const Counters& counters() const { return counters_; }
  /// The intrinsics in use, and how well they are known [px].
  const Camera& camera() const { return known_.camera; }
  PixelError uncertainty() const { return lens_fit_.report().total(known_.noise); }
  CalibrationState calibrationState() const { return health_.state; }
  const Startup& startup() const { return startup_; }
  const SegmentQueue& queue() const { return queue_; }

 private:
  // The intrinsics in use.
  struct Known {
    Camera camera;
    IntrinsicsMatrix covariance;  // empty until there is an estimate
    // Uncertainty over the part of the image that sees, without any misfit of the model.
    PixelError noise = PixelError::unknown();
  };
  struct CandidateOutcome {
    bool accepted = false;
    std::string reason;
  };

  void see(const KeyframeMessage& message);
  void considerModel(const KeyframeMessage& message);
  void switchModel(const Camera& camera, const std::vector<Segment>& observed);
  void runStartup(const Segment& history);
  void followTheBetter();
  CandidateOutcome considerCandidate(const KeyframeMessage& message);
  std::optional<CandidateOutcome> canSkipSolve(const KeyframeMessage& message);
  CandidateOutcome offer(const Candidate& candidate);
  CandidateOutcome followDrift(const ChangeVerdict& verdict);
  void considerDrift();
  void recallSetting();
  void considerRowTime();
  void adoptRowTime();
  void considerHandover();
  void considerLensFit();
  void judge();
  BackEndOutput finish();
  CalibrationReport report() const;
  QueueReport queueReport() const;

  // In beginnings.cpp.
  CandidateOutcome beginLens(const ChangeVerdict& verdict);
  void archiveQueue(std::int64_t onset_ns);

  void advance(PhaseTrigger trigger) { phase_ = after(phase_, trigger); }
  void adoptStartup(const PixelError& uncertainty);
  void adoptSolution();
  void adoptChange(int taken);
  void clearQueue();
  QueueStart queueStart() const;
  double convergedRms() const { return options_.convergedRms(known_.camera.width()); }
  void raise(EventType type, const std::string& sentence);

  Options options_;

  // What was learnt.
  Phase phase_ = Phase::kNothingKnown;
  Known known_;
  Startup startup_;
  SegmentQueue queue_;
  Shutter shutter_;
  LensWatch watch_;
  SettingArchive settings_;  // of earlier epochs
  ModelChoice model_choice_;
  LensFit lens_fit_;
  HealthVerdict health_;
  Counters counters_;

  // Of the newest keyframe.
  std::int64_t stamp_ns_ = 0;
  std::int64_t keyframes_ = 0;  // seen so far
  ImageField field_;            // the part of the image that sees
  CandidateOutcome outcome_;
  double change_p_value_ = 1.0;
  std::string obstacle_;  // to hand-over
  bool changed_ = false;  // the estimate
  std::vector<Event> events_;

  // Told so far.
  bool converged_told_ = false;
  int swaps_ = 0;  // changes of the queue
  std::string last_change_;
};

}  // namespace camera_self_calibration
