#pragma once

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/map/segment.h"
#include "camera_self_calibration/queue/agreement.h"
#include "camera_self_calibration/queue/segment_queue.h"

namespace camera_self_calibration {

/// The information of a segment about the intrinsics at its initial poses and depths: one
/// linearisation, for an eighth of the time that evaluateCandidate takes.
struct CandidateOutlook {
  bool usable = false;  ///< The intrinsics are determined.
  /// The best score that it can have as a candidate: with all tracks, and the tracker's own sigmas.
  SegmentScore best;
  /// At the given intrinsics, with the sigmas that explain the residuals there.
  QuadraticLikelihood likelihood;
  double sigma_scale = 1.0;  ///< Of these sigmas, against the tracker's own; at least 1.
};

/// `camera` is what the segment's poses and depths were estimated with, or near it.
CandidateOutlook outlookOf(const Segment& segment, const Camera& camera);

/// Whether residuals of this sigma scale are about as large as those of the queue's candidates:
/// where they are much larger, poses and depths have not settled, or the lens is another one.
bool fitsAsUsual(double sigma_scale, const SegmentQueue& queue);

}  // namespace camera_self_calibration
