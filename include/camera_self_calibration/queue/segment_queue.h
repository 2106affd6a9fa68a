#pragma once

#include <cstdint>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/problem.h"
#include "camera_self_calibration/queue/candidate_window.h"
#include "camera_self_calibration/queue/line_delay.h"
#include "camera_self_calibration/queue/queue_policy.h"
#include "camera_self_calibration/queue/queue_solution.h"
#include "camera_self_calibration/queue/scatter.h"

namespace camera_self_calibration {

/// What a joint estimate begins with, beside the segments' own poses and depths.
struct QueueStart {
  Camera camera;
  LineDelayEstimate line_delay = {};  ///< One of the unknowns; not usable: known exactly.
  double line_delay_doubt_s = 0.0;    ///< LineDelay::doubt [s].
};

/// The priority queue of the best segments (section II-B) with their joint solution. Whatever
/// happens to it:
/// - its segments were all accepted by the policy, so that no two of them share a moment;
/// - solution() is that of the segments as they are, not usable if there are none, or none that
///   explains them together.
class SegmentQueue {
 public:
  /// `threads` >= 1 for the joint estimate, which is the same for any number.
  SegmentQueue(const QueuePolicy& policy, int threads) : policy_(policy), threads_(threads) {}

  /// What offer() would do; changes nothing. `camera` as in QueuePolicy::consider.
  QueueDecision consider(const SegmentScore& candidate, const Camera& camera) const;

  /// Takes the candidate if the policy wants it.
  QueueDecision offer(const Candidate& candidate, const QueueStart& start);

  /// The same for several, one after the other, with one estimate at the end. How many were taken.
  int offer(const std::vector<Candidate>& candidates, const QueueStart& start);

  /// Takes out the segments of these sequences, then offers the candidates, and estimates anew.
  /// How many were taken.
  int exchange(const std::vector<std::int64_t>& leaving, const std::vector<Candidate>& candidates,
               const QueueStart& start);

  /// Begins anew with these: the same segments evaluated in another way. How many were taken.
  int rebuild(const std::vector<Candidate>& candidates, const QueueStart& start);

  void clear();

  /// Whether it is to know the lens as soon as possible, and leaves no time unused while it has
  /// room (QueuePolicy); not so at first.
  void setFilling(bool filling) { filling_ = filling; }

  /// How the lens drifts, seen from solution(); lasts until the next estimate.
  void setDrift(const LensDrift& drift) { solution_.drift = drift; }

  /// Solved, in the order of acceptance.
  const std::vector<Candidate>& candidates() const { return candidates_; }
  const QueueSolution& solution() const { return solution_; }

  /// The joint estimate of the rolling shutter's time between rows, about the one that
  /// they are freed of.
  LineDelayEstimate lineDelay() const;

 private:
  QueueDecision take(const Candidate& candidate);
  int takeAll(const std::vector<Candidate>& candidates);
  void remove(const std::vector<std::int64_t>& sequences);
  void solve(const QueueStart& start);
  bool settle(Problem* problem);
  void setCovariance(const Problem& problem);

  QueuePolicy policy_;
  bool filling_ = false;
  int threads_;
  std::vector<Candidate> candidates_;
  std::vector<Segment> own_;  // of each candidate, the solution that it came with
  Scatter scatter_;           // the newest that was seen
  QueueSolution solution_;
};

}  // namespace camera_self_calibration
