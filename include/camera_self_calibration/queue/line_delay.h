#pragma once

#include <vector>

#include "camera_self_calibration/estimation/problem.h"
#include "camera_self_calibration/queue/candidate_window.h"

namespace camera_self_calibration {

/// What observations say about a rolling shutter's time between rows.
struct LineDelayEstimate {
  bool usable = false;
  double line_delay_s = 0.0;
  double sigma_s = 0.0;  ///< With poses, landmarks and intrinsics as unknown as they are.
  Intrinsics slope;      ///< By how much the intrinsics' estimate moves with it; n_c [per s].
};

/// Profile of the cost about the line delay that the segments have now (Keyframe::line_delay_s),
/// which are at their solution: poses, landmarks and intrinsics follow to first order, robust
/// weights stay. The parabola through three points gives the minimum and its width. The segments
/// share the intrinsics and the line delay; `prior` as in Problem.
LineDelayEstimate estimateLineDelay(const std::vector<SegmentBlock>& blocks, const Camera& camera,
                                    const IntrinsicsPrior& prior, int threads);

/// A segment that was solved with another line delay, evaluated anew with this one.
Candidate withLineDelay(const Candidate& candidate, double line_delay_s, const Camera& start);

/// The line delay in use, from estimates of it: 0 until there is no doubt that the shutter rolls.
class LineDelay {
 public:
  /// `line_delay_s`: where to start.
  /// `row_steps`: times between rows that an image has.
  LineDelay(double line_delay_s, int row_steps) : row_steps_(row_steps), in_use_s_(line_delay_s) {}

  /// Takes an estimate, which replaces the one before; true if the value in use is another now.
  bool take(const LineDelayEstimate& estimate);

  /// An estimate made earlier, with the value in use.
  void restore(const LineDelayEstimate& estimate) { estimate_ = estimate; }

  double inUse() const { return in_use_s_; }  ///< [s]
  const LineDelayEstimate& estimate() const { return estimate_; }
  /// How far the value in use is expected to be off (root mean square) [s]. Where none is in use,
  /// the shutter may roll all the same, the more likely the less is known of it.
  double doubt() const;
  /// Whether the newest estimate is what is in use, but for a small part of its sigma.
  bool settled() const { return settled_; }

 private:
  int row_steps_;
  double in_use_s_;
  bool settled_ = false;
  LineDelayEstimate estimate_;
};

}  // namespace camera_self_calibration
