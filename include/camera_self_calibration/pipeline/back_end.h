#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "camera_self_calibration/lens_change/change_detector.h"
#include "camera_self_calibration/lens_change/lens_drift.h"
#include "camera_self_calibration/lens_change/setting_archive.h"
#include "camera_self_calibration/model_choice/lens_fit.h"
#include "camera_self_calibration/model_choice/model_choice.h"
#include "camera_self_calibration/pipeline/front_end.h"
#include "camera_self_calibration/pipeline/health.h"
#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/queue/agreement.h"
#include "camera_self_calibration/queue/candidate_window.h"
#include "camera_self_calibration/queue/queue_estimate.h"
#include "camera_self_calibration/queue/segment_queue.h"
#include "camera_self_calibration/startup/startup.h"

namespace camera_self_calibration {

struct BackEndOutput {
  CalibrationReport report;
  std::optional<CalibrationUpdate> update;
  std::vector<Event> events;
};

/// Thread 2: from keyframes to intrinsics. Startup batch first; the queue is filled meanwhile and
/// takes over when its estimate is good enough and its segments agree.
class BackEnd {
 public:
  BackEnd(const Options& options, const Camera& camera);

  BackEndOutput process(const KeyframeMessage& seen);

  /// Says what is known and that a keyframe came, but learns nothing from it. `remark` is added to
  /// the sentence. The first time after a restore there is an update too.
  BackEndOutput hold(const KeyframeMessage& message, const std::string& remark);

  /// Takes over a saved queue and solves it again; false, and nothing changed, if it is of another
  /// camera model or image size, or has no solution.
  bool restore(const LearntState& state);

  /// Offers segments scored elsewhere to the queue, after hand-over.
  BackEndOutput merge(const std::vector<Candidate>& candidates);

  /// All that was learnt; null until the queue has taken over.
  std::shared_ptr<const LearntState> state() const;

  /// Revisions go on after this one; the present estimate counts as a new one.
  void continueAfter(std::uint64_t revision) {
    report_.revision += revision;
    changed_ = true;
  }
  void beginEpoch(std::uint64_t epoch) { report_.epoch = epoch; }

  const CalibrationReport& report() const { return report_; }
  const Startup& startup() const { return startup_; }
  const std::vector<Candidate>& candidates() const { return estimate_.candidates(); }

 private:
  void reportHeldIntrinsics();
  // In lens_model.cpp: what the model describes, and whether to go on with another.
  void considerStartupModel();
  void considerLensFit();
  void chooseModel(const LensComparison& comparison);
  void switchModel(const LensTrial& lens);
  void clearQueue();
  // In handover.cpp: from the startup batch to the queue.
  void runStartup(const KeyframeMessage& message);
  struct QueueStanding {  // of the queue's estimate beside the startup batch's
    PixelError uncertainty = PixelError::unknown();
    PixelError startup_uncertainty = PixelError::unknown();
    // Further from it than the uncertainties of both explain: one of them is wrong.
    bool contradicts_startup = false;
    std::string doubt;  // why the queue's estimate is not believed; empty if it is
  };
  QueueStanding queueStanding() const;
  void followTheBetter();
  void adoptStartup(const PixelError& uncertainty);
  PixelError startupUncertainty() const;  // over the part of the image that sees, as the queue's
  void considerHandover(std::int64_t stamp_ns, std::vector<Event>* events);
  // In lens_epochs.cpp: what the watch over the lens leads to.
  void considerCandidate(const KeyframeMessage& message, std::vector<Event>* events);
  bool foregone(const KeyframeMessage& message);
  void changeEpoch(const ChangeVerdict& verdict, std::vector<Event>* events);
  void putAway(std::int64_t onset_ns);
  void followDrift(const ChangeVerdict& verdict);
  LensDrift presentDrift() const;
  void considerDrift();
  void recallSetting(std::vector<Event>* events);
  void rememberStartup();
  std::optional<Reference> startupBefore(std::int64_t stamp_ns) const;
  // In shutter.cpp: what rows that are read one after the other lead to.
  std::optional<KeyframeMessage> freed(const KeyframeMessage& message) const;
  void considerRowTime();
  void adoptRowTime();
  void reportShutter();
  void restoreShutter(const LearntState& state);
  double convergedRms() const { return options_.convergedRms(report_.camera.width()); }
  bool offer(const Candidate& candidate);
  BackEndOutput finish(BackEndOutput output);
  void solveQueue();
  void adoptSolution();
  void stateUncertainty();
  void judge(std::int64_t stamp_ns, std::vector<Event>* events);
  void fillQueueReport();

  Options options_;
  ModelChoice model_choice_;
  LensFit lens_fit_;
  Startup startup_;
  SegmentQueue queue_;
  QueueEstimate estimate_;
  QueueSolution solution_;
  ChangeDetector detector_;
  RowTime row_time_;
  int row_time_keyframes_ = 0;    // of the startup batch, when it was asked last
  int swaps_since_row_time_ = 0;  // changes of the queue since it was asked for the row time
  ImageField field_;              // the part of the image that sees
  SettingArchive settings_;       // of earlier epochs
  std::deque<std::pair<std::int64_t, Reference>> startup_course_;  // by stamp, of this epoch
  // How far stretches of this camera scatter, as its model does not describe it exactly: that of
  // the queue before the newest change; of the first lens, which no queue has told yet, three
  // sigmas.
  Scatter usual_scatter_ = {40.0 * 3.0 * 3.0, 40};
  std::int64_t epoch_onset_ns_ = 0;           // keyframes before it are of an earlier epoch
  PixelError noise_ = PixelError::unknown();  // the reported uncertainty without any misfit
  ImageField observed_;  // the part of the image that the queue's features covered
  bool handed_over_ = false;
  bool follows_queue_ = false;  // before hand-over: the queue's estimate is the better one
  bool changed_ = false;        // the estimate, by the newest keyframe
  std::string obstacle_;        // to hand-over
  CalibrationReport report_;
};

}  // namespace camera_self_calibration
