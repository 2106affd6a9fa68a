#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/lens_change/lens_change.h"
#include "camera_self_calibration/lens_change/lens_course.h"
#include "camera_self_calibration/queue/agreement.h"
#include "camera_self_calibration/queue/candidate_outlook.h"
#include "camera_self_calibration/queue/candidate_window.h"
#include "camera_self_calibration/queue/segment_queue.h"

namespace camera_self_calibration {

/// What a keyframe said of whether the camera is still the one that the queue describes.
struct ChangeVerdict {
  enum class Kind {
    kSame,     ///< Nothing speaks against it.
    kDoubt,    ///< Not decided: what is seen now must not enter the queue.
    kBadData,  ///< Fits no lens: says nothing, and must not enter the queue either.
    kDrift,    ///< The lens changed slowly: segments that describe the past should go.
    kChange    ///< The lens changed at onset_ns: an alarm.
  };
  Kind kind = Kind::kSame;
  double p_value = 1.0;           ///< Of the decisive statistic.
  std::int64_t onset_ns = 0;      ///< kChange: stamp of the first keyframe after the change.
  Camera camera;                  ///< kChange, kDrift: the estimate for what is seen now.
  IntrinsicsMatrix information;   ///< Of `camera`, n_c x n_c.
  double excess = 0.0;            ///< kChange by the newest window: its statistic per observation.
  Segment segment;                ///< kChange: the newest segment, solved; may begin earlier.
  std::vector<Candidate> recent;  ///< kChange, kDrift: disjoint segments after the change.
  std::vector<std::int64_t> stale;  ///< kDrift: sequences of the queue's segments to retire.
  std::string reason;               ///< In words, but for kSame.
};

/// Tells whether the intrinsics changed, with a stated rate of false alarms. Fast: a suspicion from
/// the frames' innovations, or a window that disagrees with the queue without what overlaps it
/// (agreement), confirmed by a likelihood ratio over the newest window with the lens before the
/// onset held (testLensChange). Slow: one account of all disjoint segments, the queue's and the
/// newest beside it (courseOfLens); it has the last word on whether what a window shows is a step
/// or part of a drift, too. Each test spends its share of the allowed false alarms, `rate * time
/// since it was last made`, so that their sum holds at all times (Bonferroni). An alarm of the
/// newest window is raised when a few keyframes in a row find the same new lens: a window solved
/// into a wrong minimum says something else at each keyframe.
class ChangeDetector {
 public:
  /// Alarms per hour while nothing changes; 0: never any alarm.
  explicit ChangeDetector(double false_alarms_per_hour) : rate_(false_alarms_per_hour) {}

  /// A keyframe's window as it came (`window`) and as a solved candidate; `suspected_onset_ns` is
  /// that of InnovationMonitor, 0 for none.
  ChangeVerdict examine(const Segment& window, const Candidate& candidate,
                        std::int64_t suspected_onset_ns, const SegmentQueue& queue);

  /// For a window that will not enter the queue: the p-value of its outlook, if that leaves no
  /// need to solve it as a candidate for examine(). Nothing where anything is suspected or in
  /// doubt, where the tracks fit worse than usual, or where the window is the first after those
  /// that the slow tests remember.
  std::optional<double> clearlySame(const CandidateOutlook& outlook,
                                    std::int64_t suspected_onset_ns, const SegmentQueue& queue);

  /// The same while the lens is still being learnt, against what was known of it before the window
  /// began. `residual_scale`: that of the data which that rests on.
  ChangeVerdict examineUnfinished(const Segment& window, const Candidate& candidate,
                                  const Reference& reference, double residual_scale);

  /// Where the lens is if it moved, from the queue's segments and the newest beside it;
  /// queue.solution() must be usable. `now_ns`: stamp of the newest keyframe.
  LensDrift drift(const SegmentQueue& queue, std::int64_t now_ns) const;

  /// The sequence of a segment of the queue that is wrong, as all others and the newest beside the
  /// queue show it: one of things that move, or in a wrong minimum. `now_ns` as in drift().
  std::optional<std::int64_t> wrongSegment(const SegmentQueue& queue, std::int64_t now_ns) const;

  /// The newest keyframe's segment is one of those beside the queue since then.
  bool hasNews() const;

  /// Forgets what was seen, at the beginning of an epoch.
  void reset() {
    recent_.clear();
    findings_ = 0;
    drift_told_ = false;
    in_doubt_ = false;
    suspected_ = false;
  }

  /// p-value below which the newest keyframe's tests raise an alarm.
  double limit() const;

 private:
  // p-value below which nothing enters the queue: chance alone keeps one window in a hundred out.
  static constexpr double kDoubt = 1e-2;
  // Two fast, one of the window, one of all segments together.
  static constexpr double kTests = 4.0;

  // p-value that a test may spend which is made once in so many seconds.
  double share(double interval_s) const { return rate_ * interval_s / 3600.0 / kTests; }

  struct RememberedSegment {
    Candidate candidate;
    QuadraticLikelihood likelihood;
  };

  static std::string withP(const char* text, double p_value);
  void measureInterval(std::int64_t stamp_ns);
  ChangeVerdict examineKeyframe(const Segment& window, const Candidate& candidate,
                                std::int64_t suspected_onset_ns, const SegmentQueue& queue);
  ChangeVerdict examineSuspicion(const Segment& window, int earlier_keyframes,
                                 const Reference& reference) const;
  ChangeVerdict examineCandidate(const Segment& window, const Candidate& candidate,
                                 const Reference& reference);
  ChangeVerdict confirmed(ChangeVerdict verdict, const Camera& before);
  ChangeVerdict examineWindow(const Segment& window, int earlier_keyframes,
                              const Reference& reference) const;
  // In slow_change.cpp: all segments.
  bool isNewSegment(std::int64_t begin_ns) const;  // shares nothing with those remembered
  void remember(const Candidate& candidate, const QuadraticLikelihood& likelihood);
  std::vector<QuadraticLikelihood> segmentsOf(const SegmentQueue& queue, std::int64_t now_ns) const;
  bool isRatherDrift(const ChangeVerdict& change, const SegmentQueue& queue) const;
  ChangeVerdict examineCourse(const SegmentQueue& queue);
  void describeStep(const SegmentQueue& queue, ChangeVerdict* verdict) const;
  void describeDrift(const LensCourse& course, const SegmentQueue& queue,
                     ChangeVerdict* verdict) const;

  double rate_;
  double interval_s_ = 0.3;  // between keyframes, running mean
  std::int64_t last_stamp_ns_ = 0;
  double usual_residual_scale_ = 1.0;
  std::deque<RememberedSegment> recent_;  // disjoint, in the order of time
  double course_limit_ = 0.0;             // p-value for all segments together, at the newest one
  bool drift_told_ = false;               // what they said then: it is asked once
  bool in_doubt_ = false;                 // what the newest keyframe said
  bool suspected_ = false;                // in this doubt, a change was seen to happen
  int findings_ = 0;                      // keyframes in a row that found the lens `found_`
  Camera found_;
};

}  // namespace camera_self_calibration
