#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/queue/score_kind.h"

namespace camera_self_calibration {

/// All that the policy looks at: never the queue's own estimate, which would bias the
/// selection towards it (section II-B).
struct SegmentScore {
  std::int64_t sequence = 0;
  std::int64_t begin_ns = 0;  ///< First and last keyframe; segments that share a moment overlap.
  std::int64_t end_ns = 0;
  double entropy = 0.0;          ///< Normalised [nats]; lower is better.
  double pixel_rms = 0.0;        ///< Expected pixel error, PixelError::rms [px]; lower is better.
  IntrinsicsMatrix information;  ///< Marginal, n_c x n_c.
  bool well_posed = true;
};

struct QueueDecision {
  bool accepted = false;
  std::vector<std::int64_t> replaced;  ///< Sequences that leave the queue.
  std::string reason;                  ///< In words.
};

/// Which segments the priority queue keeps (section II-B). By entropy a candidate is better when
/// `h_c < h - n_c ln(1/alpha)`: its geometric-mean sigma is smaller by the share 1 - alpha,
/// whatever the sign of the entropies. By pixel error it is better when `e_c < alpha e`. It is
/// compared with the worst segment; or, if it overlaps some, with these alone: with their joint
/// covariance if several, and then replaces all of them, unless it would be left alone: one segment
/// cannot be checked against others. While a queue with room is
/// filling, the time of these
/// that it does not cover would be lost: a share u of its own length could have told about u times
/// as much as it does, so that its sigmas have to be smaller by the factor sqrt(1 + u), if that is
/// more than alpha asks for.
class QueuePolicy {
 public:
  /// `capacity` >= 1 segments, alpha in (0, 1).
  QueuePolicy(int capacity, double alpha, ScoreKind kind = ScoreKind::kEntropy)
      : capacity_(capacity), alpha_(alpha), kind_(kind) {}

  /// What becomes of a candidate that is offered to a queue of these segments. `camera` gives the
  /// normalisation of a joint entropy, and the image that a joint pixel error is over. `filling`:
  /// the queue is to know the lens as soon as possible.
  QueueDecision consider(const SegmentScore& candidate, const std::vector<SegmentScore>& segments,
                         const Camera& camera, bool filling = false) const;

 private:
  int capacity_;
  double alpha_;
  ScoreKind kind_;
};

}  // namespace camera_self_calibration
