#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/plotting/track_overlay.h"
#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

/// An image of a run, with the tracks in it.
struct ExampleImage {
  std::int64_t stamp_ns = 0;
  cv::Mat gray;  ///< 8 bits.
  TrackTrails trails;
};

/// Keeps the image with most tracks; one of the present lens rather than one from before a change.
class ExampleFinder {
 public:
  /// `image` must be that of `frame`; it is copied if it is kept.
  void add(const ImageView& image, const FrameResult& frame, std::uint64_t epoch);

  /// Empty before the first image with tracks.
  const ExampleImage& found() const { return found_; }

 private:
  TrackTrails trails_;
  ExampleImage found_;
  std::uint64_t epoch_ = 0;
};

/// The image as an ideal pinhole camera would have seen it from the same place, turned to the
/// middle of the image: as wide as the lens, but at most 120 degrees. Pixels that the lens did not
/// see are black. Empty if the camera is not valid.
cv::Mat undistorted(const cv::Mat& gray, const Camera& camera);

}  // namespace camera_self_calibration
