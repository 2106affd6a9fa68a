#pragma once

#include <gtest/gtest.h>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/queue/queue_estimate.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {

/// The camera of a model that is most like this one.
inline Camera as(CameraModel model, const Camera& camera) {
  if (model == camera.model()) return camera;
  Camera fitted = fitCamera(camera, model)->camera;
  fitted.setEstimateK3(false);
  return fitted;
}

struct Queue {
  QueueEstimate estimate{1};
  QueueSolution solution;
};

/// Stretches of a trajectory one after the other, seen through `truth`, scored and solved as
/// `model`.
inline Queue queueOf(const Camera& truth, CameraModel model, int count) {
  Queue queue;
  const Camera start = as(model, truth);
  for (int i = 0; i < count; ++i) {
    SegmentOptions options;
    options.camera = truth;
    options.start_s = 1.0 + 5.0 * i;
    options.tracks.max_features = 60;
    options.tracks.pixel_sigma = 0.2;
    Segment segment = makeSegment(options, 3).segment;
    segment.sequence = i;
    queue.estimate.add(evaluateCandidate(CandidateOptions(), segment, start));
  }
  queue.solution = queue.estimate.solve(start);
  EXPECT_TRUE(queue.solution.usable);
  return queue;
}

}  // namespace camera_self_calibration
