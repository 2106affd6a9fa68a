#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "camera_self_calibration/tracking/image_view.h"
#include "camera_self_calibration/tracking/track.h"
#include "camera_self_calibration/tracking/tracking_options.h"

namespace camera_self_calibration {

/// Sigma of a good track, at most [px]; a new one is good.
inline constexpr double kGoodTrackSigma = 0.2;

/// Follows Harris corners from image to image (sections II-A, II-C): pyramidal KLT predicts, then
/// the patch is registered, with an affine warp, gain and bias, against the image in which the
/// corner was detected, so that errors do not add up along the track. Patches are cut at full or at
/// half resolution, whichever gives more in this video. What the patch shows beside
/// its own surface makes a measurement less certain before it ends the track, and a track that is
/// not found (blur, something that passes) is looked for in the next images where its neighbours
/// say that it is.
class Tracker {
 public:
  explicit Tracker(const TrackerOptions& options);
  ~Tracker();

  /// Advances all tracks into this image, and returns those that were found. The image has one size
  /// over the life of the tracker; another size drops all tracks and starts over. An image that
  /// shows nothing of what was tracked before is left out (TrackedFrame::unrelated); after six in a
  /// row, all tracks end.
  const TrackedFrame& track(const ImageView& image);

  /// Detects corners in the image tracked last, where no track is near, and starts tracks at those
  /// that the image before shows too.
  /// Returns the new ones (pixel == reference_pixel).
  std::vector<Track> detect();

  /// Up to `count` corners of the image tracked last that are no tracks, spread over the image, to
  /// know a place by [px]; about where tracks that started there would be.
  std::vector<Eigen::Vector2d> corners(int count);

  /// Ends tracks, such as those that an estimator found to be outliers. Unknown ids are ignored.
  void drop(const std::vector<std::int64_t>& ids);

  /// Ends all tracks.
  void reset();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camera_self_calibration
