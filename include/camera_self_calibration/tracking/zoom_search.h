#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "camera_self_calibration/tracking/flow_prediction.h"
#include "camera_self_calibration/tracking/pyramid.h"

namespace camera_self_calibration {

/// Bridges a zoom within one image: where the flow finds few features again it is started from
/// places scaled about the image's centre, and the scale that finds most is kept.
class ZoomSearch {
 public:
  /// After `flow` has run from `points` to `predicted`. Does nothing while it found enough of them;
  /// else tries the scales and leaves the best in `flow` and `predicted`.
  void run(const ImagePyramid& from, const ImagePyramid& to, const std::vector<cv::Point2f>& points,
           FlowPrediction* flow, std::vector<cv::Point2f>* predicted);

 private:
  std::vector<cv::Point2f> trial_;
  std::vector<cv::Point2f> best_;
};

}  // namespace camera_self_calibration
