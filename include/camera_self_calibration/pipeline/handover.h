#pragma once

#include <string>

#include "camera_self_calibration/camera/image_field.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/pipeline/phase.h"
#include "camera_self_calibration/queue/segment_queue.h"
#include "camera_self_calibration/startup/startup.h"

namespace camera_self_calibration {

/// The queue's estimate beside the startup batch's, before hand-over.
struct QueueStanding {
  PixelError uncertainty = PixelError::unknown();          ///< Of the queue's [px].
  PixelError startup_uncertainty = PixelError::unknown();  ///< Of the startup batch's [px].
  /// Further apart than both uncertainties explain: one of them is wrong.
  bool contradicts_startup = false;
  std::string doubt;  ///< Why the queue's is not believed, in words; empty if it is.
  /// Nothing speaks against the queue's, but it rests on one segment, which no other checks.
  bool unchecked = false;
};

/// Both uncertainties over the part of the image that sees, `field`.
QueueStanding queueStanding(const Startup& startup, const SegmentQueue& queue,
                            const ImageField& field);

/// Of the startup batch, over the part of the image that sees [px]; infinite until it is usable.
PixelError startupUncertainty(const Startup& startup, const ImageField& field);

/// What a queue that is believed has to reach for hand-over.
struct HandoverLimits {
  double pixel_rms = 0.0;  ///< [px]
  double entropy = 0.0;    ///< Normalised [nats]; enough in place of the pixels.
};

/// Which of the two knows the lens better, if any knows it. The batch forgets: it begins anew in
/// every map, and in fast motion leaves out the oldest keyframes. The queue does not: where the
/// batch tells nothing, one segment that is good enough for hand-over is enough to go on with.
PhaseTrigger betterEstimate(const Startup& startup, const QueueStanding& standing,
                            const HandoverLimits& limits);

/// Why its estimate is not good enough yet, in words; empty if it is.
std::string shortfall(const QueueStanding& standing, const QueueSolution& solution,
                      const HandoverLimits& limits);

}  // namespace camera_self_calibration
