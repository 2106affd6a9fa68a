#pragma once

#include "camera/sample_cameras.h"
#include "camera_self_calibration/camera/fit.h"
#include "queue/sample_queues.h"

namespace camera_self_calibration {

/// The camera of a model that is most like this one.
inline Camera as(CameraModel model, const Camera& camera) {
  if (model == camera.model()) return camera;
  Camera fitted = fitCamera(camera, model)->camera;
  fitted.setEstimateK3(false);
  return fitted;
}

/// Separate segments seen through `truth`, scored and solved as `model`.
inline SegmentQueue queueOf(const Camera& truth, CameraModel model, int count) {
  return solvedQueue(separateSegments(truth, count), as(model, truth));
}

}  // namespace camera_self_calibration
