#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "camera_self_calibration/tracking/harris.h"
#include "camera_self_calibration/tracking/pyramid.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

/// What most programs use: OpenCV's pyramidal Lucas-Kanade from image to image, a check back (0.5
/// px), and RANSAC on the fundamental matrix (1 px). Of the tracker's own features, so many at
/// once.
class KltTracker {
 public:
  explicit KltTracker(int max_features) : max_features_(max_features) {}

  /// Advances all tracks into the image, then starts new ones where none is near. Returns those
  /// that were followed.
  std::vector<Track> track(const ImageView& image);

  /// The tracks that the last image began.
  const std::vector<Track>& begun() const { return begun_; }

 private:
  void follow(const cv::Mat& image);
  void detect(const ImageView& image);

  int max_features_;
  std::int64_t next_id_ = 0;
  cv::Mat last_;
  ImagePyramid pyramid_;
  HarrisDetector harris_;
  std::vector<Track> tracks_;
  std::vector<Track> begun_;
};

}  // namespace camera_self_calibration
